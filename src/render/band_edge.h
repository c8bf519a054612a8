// SPDX-License-Identifier: Apache-2.0
// Where the band of a clamped field ends.
#pragma once

#include "render/plane.h"

namespace standoff {

/// The plane with clamped values next to the band made up: linear from the two samples before them. So the level
/// `thickness` of values interpolated between samples is where the band ends, as smooth as any other level; between
/// clamped values it would follow the squares of the samples.
Plane beyond_band(const Plane& plane, float thickness);

}  // namespace standoff
