// SPDX-License-Identifier: Apache-2.0
// Duplicate triangles, in the same or in the opposite orientation, and which of them count.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "sign/diagnosis/mesh_edges.h"
#include "standoff/mesh.h"

namespace standoff {

/// A face is a set of three positions; all triangles there are its copies. Copies in opposite orientation cancel each
/// other in the winding number, copies in the same orientation add up. Both can be meant: the wall between two boxes
/// that share a face is there twice, once for each box, and a solid may be listed twice; a car's window is modelled
/// with a front and a back. And both can be an accident: a triangle of a sphere listed again, in either orientation.
///
/// The number of copies that closes the surface around them decides. Faces with copies form groups, joined over edges
/// of two faces that both have copies. At the other edges of a group, an odd number of other faces is a vote for one
/// copy, an even number is a vote for none or all:
/// - Most edges vote for one: each face keeps one copy (the sphere).
/// - Else pairs in opposite orientation leave out both (the wall, the window), and all others are kept.
/// - A group without such edges is a closed surface: if it consists of pairs, one of each is kept, else all.
/// A mesh is two-sided if kTwoSided of its triangles are in opposite pairs. Then one of each pair is kept, wherever the
/// mesh has its holes. The same holds for parts of a mesh that are bodies (TwoSidedParts).
struct Duplicates {
  std::vector<std::int8_t> use;  ///< for each triangle 0 if it is left out, else 1; empty: all are used
  /// Pairs of a triangle that is kept and an opposite one that is left out: either may stand for the other.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> either;
  std::int64_t repeated = 0;  ///< triangles with an earlier copy in any orientation
  std::int64_t same = 0;      ///< triangles with an earlier copy in the same orientation
  std::int64_t opposite = 0;  ///< pairs in opposite orientation; each triangle is in one pair at most
  std::int64_t left_out = 0;
  std::vector<std::uint8_t> paired;  ///< for each triangle whether it is in such a pair; empty if there are none
  bool same_winding = true;  ///< the triangles left out cancel, so the winding number is the same as with all triangles
  bool two_sided = false;
};

/// Which share of the triangles must be in opposite pairs. Files of two-sided models have some triangles three times,
/// and a few faces once.
inline constexpr double kTwoSided = 0.9;

/// Parts that are there in both orientations, such as the cushions of a chair whose frame is not. A part, triangles
/// that share positions directly or through others, is two-sided if kTwoSided of its triangles are in opposite pairs.
/// To leave out both triangles of a pair is right for a pane of a closed body: the pane has no inside, and vanishes. It
/// is wrong for a body with holes, because then the body vanishes, and only the rest of the mesh has an inside. So one
/// triangle of each pair is used in parts that are bodies once they have one side: nothing of them is unorientable,
/// most of their area belongs to solids (is_solid), and caps of less than a third of their area close their holes.
struct TwoSidedParts {
  std::vector<std::uint32_t> of;   ///< the part of each triangle, or kNone; empty if there are no such parts
  std::vector<std::uint8_t> kept;  ///< for each part: whether one triangle of each pair is used
  static constexpr std::uint32_t kNone = 0xffffffff;

  std::size_t size() const { return kept.size(); }
  bool keeps(std::size_t triangle) const { return !of.empty() && of[triangle] != kNone && kept[of[triangle]] != 0; }
};

/// Requires the edges of the mesh. Pairs in `parts` that are kept keep one triangle.
Duplicates find_duplicates(const MeshEdges& edges, std::size_t triangles, const TwoSidedParts& parts);

/// The two-sided parts of a mesh that is not two-sided as a whole. Requires the edges of the mesh, and the duplicates
/// found without two-sided parts. Takes linear time but for the sorting of nonmanifold edges.
TwoSidedParts find_two_sided_parts(MeshView mesh, const MeshEdges& edges, const Duplicates& duplicates);

}  // namespace standoff
