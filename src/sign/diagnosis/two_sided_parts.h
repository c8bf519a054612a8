// SPDX-License-Identifier: Apache-2.0
// Parts of a mesh that are there in both orientations, such as the cushions of a chair whose frame is not.
#pragma once

#include <cstdint>
#include <vector>

#include "sign/diagnosis/copies.h"
#include "sign/diagnosis/mesh_edges.h"
#include "standoff/mesh.h"

namespace standoff {

/// A part, triangles that share positions directly or through others, is two-sided if kTwoSided of its triangles are in
/// opposite pairs. Pairs that leave out both are right for a pane of a closed body: it has no inside, and is no longer
/// there. For a body with holes they are wrong: it vanishes, and the rest of the mesh alone is what has an inside. So
/// one triangle of each pair is used in parts that are bodies once they have one side: nothing of them is
/// unorientable, most of their area belongs to solids (solid.h), and less than a third of it closes their holes.
struct TwoSidedParts {
  std::vector<std::uint32_t> of;   ///< for each triangle its part, or kNone; empty if there are none
  std::vector<std::uint8_t> kept;  ///< for each part: whether one triangle of each pair is used

  static constexpr std::uint32_t kNone = 0xffffffff;
  std::size_t size() const { return kept.size(); }
  bool keeps(std::size_t triangle) const { return !of.empty() && of[triangle] != kNone && kept[of[triangle]] != 0; }
};

/// Of a mesh that is not two-sided as a whole. Requires the edges of the mesh and what find_copies() finds without
/// these parts. Linear up to the sorting of nonmanifold edges.
TwoSidedParts find_two_sided_parts(MeshView mesh, const MeshEdges& edges, const Copies& copies);

}  // namespace standoff
