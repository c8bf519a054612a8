// SPDX-License-Identifier: Apache-2.0
// The slab between two triangles that are apart: a separating direction, from which sweeps bound the time of impact.
#pragma once

#include "geometry/triangle_pair.h"

namespace standoff {

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
