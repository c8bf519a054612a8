// SPDX-License-Identifier: Apache-2.0
// Triangles that a mesh has more than once, in the same or in the opposite orientation, and which of them count.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "sign/diagnosis/mesh_edges.h"

namespace standoff {

/// A face is a set of three positions, all triangles there are its copies. Copies in opposite orientation cancel each
/// other in the winding number, copies in the same orientation add up. Both can be meant: the wall between two boxes
/// that share a face is there twice, once for each box, and a solid may be listed twice; a car's window is modelled
/// with a front and a back. And both can be an accident: a triangle of a sphere listed again, in either orientation.
///
/// What decides is which number of copies closes the surface around. Faces with copies form groups, joined over edges
/// of two faces that both have copies. At the other edges of a group, an odd number of other faces speaks for one copy,
/// an even number for none or as many as there are:
/// - Most edges speak for one: each face keeps one copy (the sphere).
/// - Else pairs in opposite orientation leave out both (the wall, the window), and all others are kept.
/// - A group without such edges is a closed surface: if it consists of pairs, one of each is kept, else all.
/// A mesh is two-sided if kTwoSided of its triangles are in opposite pairs. Then one of each pair is kept, wherever the
/// mesh has its holes. The same holds for parts of a mesh that are bodies (two_sided_parts.h).
struct Copies {
  std::vector<std::int8_t> use;  ///< for each triangle 0 if it is left out, else 1; empty: all are used
  /// Triangles kept with one in the opposite orientation that was left out: the one may stand for the other.
  std::vector<std::pair<std::uint32_t, std::uint32_t>> either;
  std::int64_t repeated = 0;  ///< triangles with an earlier copy in any orientation
  std::int64_t same = 0;      ///< triangles with an earlier copy in the same orientation
  std::int64_t opposite = 0;  ///< pairs in opposite orientation; each triangle is in one pair at the most
  std::int64_t left_out = 0;
  std::vector<std::uint8_t> paired;  ///< for each triangle whether it is in such a pair; empty if there are none
  bool same_winding = true;          ///< whether what is left out cancels: the winding number is that of all triangles
  bool two_sided = false;
};

/// Which share of the triangles must be in opposite pairs. Files of two-sided models have some triangles three times,
/// and a few faces once.
inline constexpr double kTwoSided = 0.9;

struct TwoSidedParts;

/// Requires the edges of the mesh. `parts`: those whose pairs keep one triangle.
Copies find_copies(const MeshEdges& edges, std::size_t triangles, const TwoSidedParts& parts);

}  // namespace standoff
