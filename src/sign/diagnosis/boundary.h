// SPDX-License-Identifier: Apache-2.0
// The boundary of an oriented mesh: the edges whose half-edges do not cancel each other. It falls into connected loops,
// and these into polygons without repeated corners.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "sign/diagnosis/mesh_edges.h"
#include "sign/oriented_mesh.h"
#include "standoff/vec.h"

namespace standoff {

/// An edge that the triangles use more often in one direction than in the other.
struct BoundaryEdge {
  Vec3 from, to;        ///< in the direction of the half-edges in excess
  std::int32_t weight;  ///< the number of half-edges in excess; positive
};

/// The mesh becomes closed with the triangles (c, to, from), `weight` times each, whatever point c is. Each loop may
/// have a point of its own, because a loop is closed by itself.
struct Boundary {
  std::vector<BoundaryEdge> edges;
  std::vector<std::size_t> begin = {0};  ///< loop n is edges[begin[n]] to edges[begin[n + 1] - 1]

  std::size_t loops() const { return begin.size() - 1; }
  std::span<const BoundaryEdge> loop(std::size_t n) const {
    return std::span(edges).subspan(begin[n], begin[n + 1] - begin[n]);
  }
};

/// Edges are in one loop if shared positions connect them, so loops that touch are one. Loops, and the edges of a loop,
/// are in the order of the mesh's positions. Requires the edges of mesh.mesh.
Boundary net_boundary(const OrientedMesh& mesh, const MeshEdges& edges);

/// The sum of the edges' lengths. Each counts once, whatever its weight.
double length_of(std::span<const BoundaryEdge> loop);
/// An estimate of the largest distance between points of a loop: never more, at least 1 / sqrt(3) of it, and exact for
/// triangles. Takes linear time.
double diameter_of(std::span<const BoundaryEdge> loop);

/// A closed polygon without repeated corners, in the direction of the boundary: the first corner follows the last one.
struct BoundaryPolygon {
  std::vector<Vec3> corners;  ///< at least two
  std::int32_t weight;        ///< positive
};

/// Calls use(polygon) for polygons whose sum is the boundary. Where a polygon can go on in several ways, it turns back
/// as sharply as it can. So a T-junction, where an edge runs along one side of a crack and its parts along the other,
/// becomes a polygon of its own without area, although it shares its ends with others. Takes linear time, and about 60
/// bytes per edge of the largest loop.
void for_each_polygon(const Boundary& boundary, const std::function<void(BoundaryPolygon)>& use);

/// The cap that closes a polygon: the triangles (mean of the corners, next corner, corner), `weight` times each.
struct CapSums {
  double area = 0;
  double volume = 0;  ///< of the cones from a point to the cap. Mesh and caps together enclose the closed mesh's volume
};
CapSums cap_sums_of(const BoundaryPolygon& polygon, const Vec3& origin);

}  // namespace standoff
