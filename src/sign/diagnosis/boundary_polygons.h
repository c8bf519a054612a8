// SPDX-License-Identifier: Apache-2.0
// The boundary of a mesh as polygons, and what it takes to close them.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "sign/diagnosis/boundary.h"

namespace standoff {

/// A closed polygon without repeated corners, in the direction of the boundary: the last corner is followed by the
/// first.
struct BoundaryPolygon {
  std::vector<Vec3> corners;  ///< two at least
  std::int32_t weight;        ///< positive
};

/// Polygons whose sum is the boundary. Where a polygon can go on in several ways, it turns back as sharply as it can.
/// So a T-junction, where an edge runs along one side of a crack and its parts along the other, becomes a polygon of
/// its own without area, although its ends are those of others. Linear; takes about 60 bytes per edge of the largest
/// loop.
void for_each_polygon(const Boundary& boundary, const std::function<void(BoundaryPolygon)>& use);

/// The triangles (mean of the corners, next corner, corner), `weight` times each: they close a polygon.
struct Cap {
  double area = 0;
  double volume = 0;  ///< of the cones to them from a point. With those to the mesh, that of the closed mesh
};
Cap cap_of(const BoundaryPolygon& polygon, const Vec3& origin);

}  // namespace standoff
