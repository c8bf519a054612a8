// SPDX-License-Identifier: Apache-2.0
// Two triangles in the same coordinates, which may be slivers, segments or points: whether, where and how deep they
// intersect; how far apart they are, and the slab between them.
#pragma once

#include "geometry/predicates.h"
#include "geometry/rounding.h"

namespace standoff {

/// Whether the triangles have a point in common, exactly. Segments and points count as triangles.
bool triangles_intersect(const Corners& p, const Corners& q);

struct ClosestPair {
  double distance_sq;
  Vec3 on_p, on_q;
  Vec3 separation;  ///< from on_p to on_q; far from the origin, their difference would lose digits
};

/// The closest points of two triangles that do not cross. If they touch at an edge, both are the point of contact; if
/// they cross, they are the closest points of edges and corners alone. The error of the distance is at most
/// kDistanceRounding of their extent, the longest side of the box around both.
inline constexpr double kDistanceRounding = 32 * kRoundoffDouble;
ClosestPair closest_points(const Corners& p, const Corners& q);

/// The longest side of the box around both triangles.
double extent_of(const Corners& p, const Corners& q);

/// The penetration of two intersecting triangles.
struct Penetration {
  Vec3 point;    ///< the middle of their intersection, or a common corner if neither crosses the other's plane
  Vec3 normal;   ///< unit length: moving q along it by `depth` separates them
  double depth;  ///< after that move they are apart, or only just touch
};

/// The point alone, by exact signs and accurate determinants, for any angle between the triangles. It lies on both,
/// within 8 u of their largest coordinate (docs/distance.md).
Vec3 common_point(const Corners& p, const Corners& q);

/// The largest error of points and depths, as a share of the pair's extent.
inline constexpr double kPenetrationError = 1e-9;
/// Finds the penetration. If the triangles only touch, or are nearer than rounding, the point lies between them, and
/// the depth may be 0.
Penetration penetration(const Corners& p, const Corners& q);

/// The space between two parallel planes: one triangle lies on one side of it, the other on the other side.
struct Slab {
  Vec3 normal;       ///< unit length, towards the second triangle
  double height[3];  ///< the heights of the second triangle's corners over the first one's highest corner
  double thickness;  ///< the least of them; zero or less if the normal does not separate the triangles
};

/// The slab along the direction between their closest points, whose thickness is their distance. If they are so near
/// that rounding has turned that direction, it takes the best direction of their features: the normals, the directions
/// across an edge of each, and the directions across one edge. The error of heights is a few roundings of the pair's
/// extent.
Slab slab_between(const Corners& p, const Corners& q, const ClosestPair& closest);

}  // namespace standoff
