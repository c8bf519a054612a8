// SPDX-License-Identifier: Apache-2.0
// The closest point of a triangle with what is known about it, by the measure of geometry/triangle_distance.h.
#pragma once

#include <array>

#include "geometry/triangle_distance.h"
#include "standoff/points.h"

namespace standoff {

/// Corners relative to the query point, in any unit. `point` and `distance` of the answer are relative to it too, in
/// that unit; the distance is the root of origin_distance_sq(), bit by bit.
ClosestPoint closest_in_triangle(const std::array<Triple<double>, 3>& corners);

}  // namespace standoff
