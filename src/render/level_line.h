// SPDX-License-Identifier: Apache-2.0
// Lines where a field has a given value.
#pragma once

#include <vector>

#include "render/plane.h"

namespace standoff {

/// The plane's values at the centres of a picture's pixels, `width` by `height`, row by row from the top: linear
/// between samples, which are in the middle of their squares; in the outermost half squares, that of the outermost
/// sample.
std::vector<float> interpolated(const Plane& plane, int width, int height);

/// How much of each pixel a line covers that is `line_width` pixels wide, at most 2, and smooth, where `values` (as
/// interpolated() gives them) pass `level`; values equal to the level count as above it. Values that are not finite
/// have no line beside them.
std::vector<float> level_line(const std::vector<float>& values, int width, int height, double level, double line_width);

/// How much of each pixel lies where `values` are at least `level`, with a smooth edge. Values that are no numbers are
/// not.
std::vector<float> share_above(const std::vector<float>& values, int width, int height, double level);

}  // namespace standoff
