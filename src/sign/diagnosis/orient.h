// SPDX-License-Identifier: Apache-2.0
// The orientation in which a mesh's sign is decided. Files are often wrong: faces flipped one by one, parts inside out,
// faces listed twice. The winding number counts what is there; this finds what was meant, where it can.
//
// 1. Copies of triangles that the surface around them does not need are left out (duplicates.h). If they cancel each
//    other, and nothing else is to be done, they stay. One side is used of parts that are there in both orientations
//    and are bodies with holes.
// 2. Neighbours within a patch are made consistent; the majority of the triangles stays (patches.h).
// 3. Patches that meet at nonmanifold edges and do not cancel there are flipped so that they do. Where some are walls
//    between rooms, the outer hull faces outwards, and the walls are left out (patches.h).
// 4. Pieces with a volume are oriented outwards: a piece that no other contains must have a positive volume, and is
//    flipped together with all that is inside it. After that a piece of negative volume stays a cavity if it is inside
//    an odd number of others, and is flipped if it is inside an even number. Pieces of positive volume stay, solids
//    inside solids. So a mesh that is inside out as a whole, with its cavities, gives the same result as the right one.
// Step 3 is the last for a piece without a volume, for a sheet (is_solid), and for a piece that cannot be oriented.
// This holds too for bodies whose hole is so large that they count as sheets (kSheetNormals): half a ball, a flat room
// without its ceiling. They are hills and bowls as well, of which either side may be meant; so one that is inside out
// stays so.
#pragma once

#include <cstdint>
#include <vector>

#include "sign/diagnosis/mesh_edges.h"
#include "standoff/mesh.h"

namespace standoff {

struct Orientation {
  std::vector<std::int8_t> use;                       ///< OrientedMesh::use; empty: all triangles as they are
  std::int64_t flipped = 0;                           ///< triangles that are used in the opposite orientation
  std::int64_t left_out = 0;                          ///< triangles that are not used: copies and walls
  std::int64_t walls = 0;                             ///< Pieces::walls
  std::int64_t repeated = 0, same = 0, opposite = 0;  ///< the counts of Duplicates
  std::int64_t patches = 0;                           ///< of triangles that are used and have no two equal corners
  std::int64_t unorientable = 0;                      ///< patches with one side only
  std::int64_t inconsistent_before = 0;  ///< edges of exactly two triangles with the same direction in both
  std::int64_t inconsistent_after = 0;   ///< the same after orientation: only unorientable patches have such edges
  std::int64_t boundary_edges = 0;       ///< after orientation: edges whose half-edges do not cancel
  /// Parts in both orientations of which nothing is used (TwoSidedParts), and their share of the mesh's area.
  std::int64_t cancelled_parts = 0;
  double cancelled_share = 0;
  bool two_sided = false;     ///< nearly every face is there twice, once in each orientation
  bool nesting_known = true;  ///< false: there are too many parts, and none was flipped by its volume
};

/// Requires a valid mesh and its edges. Does not depend on the number of threads; the counts do not depend on the order
/// of the triangles or of their corners unless parts of equal size contradict each other. Applied to its own result it
/// changes nothing. Takes linear time but for the sorting of nonmanifold edges and the search for nested parts. Runs on
/// the threads of the calling TBB arena.
Orientation orient(MeshView mesh, const MeshEdges& edges);

}  // namespace standoff
