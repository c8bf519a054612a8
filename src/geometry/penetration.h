// SPDX-License-Identifier: Apache-2.0
// Where two triangles intersect, and the shortest translation that separates them: for slivers, segments and points
// too.
#pragma once

#include "geometry/coplanar.h"

namespace standoff {

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

}  // namespace standoff
