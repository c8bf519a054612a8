// SPDX-License-Identifier: Apache-2.0
// The line between the inside and the outside of a signed field.
#pragma once

#include <vector>

#include "render/plane.h"

namespace standoff {

/// How much of each pixel the line covers, 0 to 1, row by row from the top, for a picture of the plane of `width` by
/// `height` pixels. The line is one pixel wide and smooth. It passes where the values, interpolated between samples,
/// change their sign; 0 counts as outside, and values that are not finite have no line beside them.
std::vector<float> zero_line(const Plane& plane, int width, int height);

}  // namespace standoff
