// Where two triangles touch, and the shortest way out: right for slivers, segments and points too.
#pragma once

#include "geometry/coplanar.h"

namespace standoff {

/// Where and how deep two touching triangles are in each other.
struct Overlap {
  Vec3 point;    ///< of both: the middle of what they share, or a corner that both have where neither crosses the other
  Vec3 normal;   ///< unit length, the way q has to go
  double depth;  ///< how far: then they are apart, or only just touch
};

/// Points and depths err by this at the most, in terms of the pair's extent.
inline constexpr double kOverlapError = 1e-9;
/// For triangles that touch, or are nearer than rounding: then the point lies between them, and the depth may be 0.
Overlap overlap(const Corners& p, const Corners& q);

}  // namespace standoff
