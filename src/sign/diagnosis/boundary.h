// SPDX-License-Identifier: Apache-2.0
// The boundary of an oriented mesh: the edges whose sides do not cancel each other.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sign/diagnosis/mesh_edges.h"
#include "sign/oriented_mesh.h"
#include "standoff/vec.h"

namespace standoff {

/// An edge that the triangles use more often in one direction than in the other.
struct BoundaryEdge {
  Vec3 from, to;        ///< in the direction of the sides in excess
  std::int32_t weight;  ///< how many are in excess; positive
};

/// The triangles with the triangles (c, to, from), `weight` times each, are a closed mesh, whatever point c is: of each
/// loop one, because a loop is closed by itself.
struct Boundary {
  std::vector<BoundaryEdge> edges;
  std::vector<std::size_t> begin = {0};  ///< loop n is edges[begin[n]] to edges[begin[n + 1]]

  std::size_t loops() const { return begin.size() - 1; }
  std::span<const BoundaryEdge> loop(std::size_t n) const {
    return std::span(edges).subspan(begin[n], begin[n + 1] - begin[n]);
  }
};

/// Edges are in one loop if shared positions connect them, so loops that touch are one. Loops, and the edges of a loop,
/// are in the order of the mesh's positions. `edges` are those of mesh.mesh.
Boundary net_boundary(const OrientedMesh& mesh, const MeshEdges& edges);

/// The sum of the edges' lengths, each counted once whatever its weight.
double length_of(std::span<const BoundaryEdge> loop);

/// About the largest distance between points of a loop: never more, at least 1 / sqrt(3) of it, and exact for
/// triangles. Linear.
double diameter_of(std::span<const BoundaryEdge> loop);

}  // namespace standoff
