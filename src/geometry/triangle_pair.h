// SPDX-License-Identifier: Apache-2.0
// Two triangles in the same coordinates: do they intersect, how far apart are they?
#pragma once

#include "geometry/coplanar.h"
#include "geometry/rounding.h"

namespace standoff {

/// Whether the triangles have a point in common, exactly. Segments and points count as triangles.
bool triangles_intersect(const Corners& p, const Corners& q);

struct ClosestPair {
  double distance_sq;
  Vec3 on_p, on_q;
  Vec3 separation;  ///< from on_p to on_q; far from the origin their difference would have lost digits
};

/// The closest points of two triangles that do not cross: of touching ones where they touch at an edge, of crossing
/// ones those of their edges and corners. The distance errs by kDistanceRounding of their extent at the most: the
/// longest side of the box around both.
inline constexpr double kDistanceRounding = 32 * kRoundoffDouble;
ClosestPair closest_points(const Corners& p, const Corners& q);

/// The longest side of the box around both.
double extent_of(const Corners& p, const Corners& q);

}  // namespace standoff
