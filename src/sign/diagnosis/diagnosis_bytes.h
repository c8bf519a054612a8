// SPDX-License-Identifier: Apache-2.0
// How much memory the diagnosis of a mesh takes: what it is built of is counted first, in a fraction of that memory.
#pragma once

#include <cstdint>

#include "standoff/mesh.h"

namespace standoff {

/// What a mesh is built of, as far as memory depends on it.
struct MeshCounts {
  std::int64_t triangles = 0, vertices = 0;
  std::int64_t positions = 0;      ///< distinct
  std::int64_t patches = 0;        ///< as long as all copies of triangles are used
  std::int64_t bodies = 0;         ///< patches with enough triangles to enclose something
  std::int64_t open = 0;           ///< edges of one triangle
  std::int64_t sides = 0;          ///< of nonmanifold edges: of more than two
  std::int64_t inconsistent = 0;   ///< edges of two triangles that run along it in the same direction
  std::int64_t copies = 0;         ///< triangles of faces that are there more than once
  std::int64_t opposite = 0;       ///< faces that are there twice, once in each orientation
  bool orientable = true;          ///< whether each patch is
  std::int64_t winding_range = 0;  ///< bytes: winding_range_bytes(), unless the mesh stays open

  /// The most half-edges in excess on the boundary (Boundary), in the mesh's own orientation or in that of the
  /// diagnosis.
  std::int64_t most_boundary(bool as_oriented) const;
};

/// Takes some 20 bytes for each triangle and 16 for each vertex; more where a few positions have most of the edges, but
/// always less than a diagnosis. Requires a valid mesh. Runs on the threads of the calling TBB arena.
MeshCounts count_mesh(MeshView mesh, int threads);
/// At most these of any mesh with so many triangles.
MeshCounts most_counts(std::int64_t triangles, int threads);

/// The most bytes that MeshEdges and diagnose() hold. What find_nesting() keeps of bodies that pass through each other
/// is not bounded by these counts.
std::int64_t diagnosis_bytes(const MeshCounts& mesh, bool as_oriented);
/// The most bytes that a Boundary takes for each of its edges.
inline constexpr std::int64_t kBoundaryEdgeBytes = 68;
/// The bytes of what a plan keeps: an orientation, and a boundary of so many edges.
constexpr std::int64_t kept_plan_bytes(std::int64_t triangles, std::int64_t boundary) {
  return triangles + kBoundaryEdgeBytes * boundary;
}

}  // namespace standoff
