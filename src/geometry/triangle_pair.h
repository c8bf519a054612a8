// SPDX-License-Identifier: Apache-2.0
// Two triangles in the same coordinates: do they intersect, where and how deep? How far apart are they, and what lies
// between them? For slivers, segments and points too.
#pragma once

#include "geometry/predicates.h"
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

/// Where and how deep two intersecting triangles are in each other.
struct Penetration {
  Vec3 point;    ///< of both: the middle of what they share, or a corner that both have where neither crosses the other
  Vec3 normal;   ///< unit length: q separates along it
  double depth;  ///< how far: then they are apart, or only just touch
};

/// The point alone, for a query that asks for no more: from exact signs and accurate determinants, whatever the angle
/// between the triangles. It lies on both, within 8 u of their largest coordinate (docs/distance.md).
Vec3 common_point(const Corners& p, const Corners& q);

/// Points and depths err by this at the most, in terms of the pair's extent.
inline constexpr double kPenetrationError = 1e-9;
/// For triangles that touch, or are nearer than rounding: then the point lies between them, and the depth may be 0.
Penetration penetration(const Corners& p, const Corners& q);

/// All of the one triangle lies on one side of it, all of the other on the other side.
struct Slab {
  Vec3 normal;       ///< unit length, to the second triangle
  double height[3];  ///< of the second one's corners over the first one's highest
  double thickness;  ///< the least of them; zero or less where the normal does not separate them
};

/// The slab along the direction of their closest points, as thick as these are apart. Where they are so near that
/// rounding has turned that direction, along the best of the directions that features have by themselves: the normals,
/// those across an edge of each, and those across one edge. Heights err by a few roundings of the pair's extent.
Slab slab_between(const Corners& p, const Corners& q, const ClosestPair& closest);

}  // namespace standoff
