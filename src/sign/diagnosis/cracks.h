// SPDX-License-Identifier: Apache-2.0
// Whether the gaps of an open mesh are cracks alone: between triangles that share their corners but for rounding.
#pragma once

#include <cstdint>

#include "sign/diagnosis/mesh_edges.h"
#include "standoff/mesh.h"

namespace standoff {

/// Positions at open edges count as one that are no farther apart than this part of the mesh's longest side. Wider than
/// what files of few digits make of a corner, and a small part of any useful spacing.
inline constexpr double kCrackWidth = 1e-4;

struct Cracks {
  /// The mesh has open edges, and with its cracks welded none is left. False too if most of its triangles are copies of
  /// others then, as in sheets with a front and a back.
  bool all = false;
  std::int64_t inconsistent_edges = 0;  ///< welded edges of two triangles that run along it in the same direction
};

/// An edge is open here if it has an odd number of triangles; orientation does not matter. Nothing is moved: whoever
/// decides a sign by it has to pass over cracks of that width by other means. Linear up to sorting. Requires a valid
/// mesh and its edges.
Cracks find_cracks(MeshView mesh, const MeshEdges& edges);

}  // namespace standoff
