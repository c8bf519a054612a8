// Two triangles in the same coordinates: do they touch, how near are they, where?
#pragma once

#include <array>

#include "difi/vec.h"

namespace difi {

using Corners = std::array<Vec3, 3>;

/// Whether the triangles have a point in common, exactly. Segments and points count as triangles.
bool triangles_touch(const Corners& p, const Corners& q);

struct ClosestPair {
  double distance_sq;
  Vec3 on_p, on_q;
};

/// The closest points of two triangles that do not cross: of touching ones where they touch at an edge, of crossing
/// ones those of their edges and corners. Errors are those of double arithmetic.
ClosestPair closest_points(const Corners& p, const Corners& q);

/// Where and how deep two touching triangles are in each other.
struct Overlap {
  Vec3 point;   ///< the middle of the segment they share
  Vec3 normal;  ///< unit length, the way q has to go
  double depth;
};
Overlap overlap(const Corners& p, const Corners& q);

}  // namespace difi
