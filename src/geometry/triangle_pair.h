// Two triangles in the same coordinates: do they touch, how near are they?
#pragma once

#include "geometry/coplanar.h"

namespace standoff {

/// Whether the triangles have a point in common, exactly. Segments and points count as triangles.
bool triangles_touch(const Corners& p, const Corners& q);

struct ClosestPair {
  double distance_sq;
  Vec3 on_p, on_q;
  Vec3 way;  ///< from on_p to on_q; far from the origin their difference would have lost digits
};

/// The closest points of two triangles that do not cross: of touching ones where they touch at an edge, of crossing
/// ones those of their edges and corners. The distance errs by kDistanceRounding of their extent at the most: the
/// longest side of the box around both.
inline constexpr double kDistanceRounding = 32 * 0x1p-53;
ClosestPair closest_points(const Corners& p, const Corners& q);

/// The longest side of the box around both.
double extent_of(const Corners& p, const Corners& q);

}  // namespace standoff
