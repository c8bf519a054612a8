// SPDX-License-Identifier: Apache-2.0
// Pieces: patches that border on each other at nonmanifold edges, each turned so that the borders cancel, or left out.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sign/diagnosis/mesh_edges.h"
#include "sign/diagnosis/patches.h"
#include "standoff/mesh.h"

namespace standoff {

/// What is turned as a whole: a patch that is closed by itself, as most are, or patches joined over nonmanifold edges
/// at which they have a border. (Two boxes that share an edge are two pieces: each cancels itself there.)
struct Pieces {
  std::vector<std::uint32_t> of;           ///< for each triangle its piece
  std::vector<std::uint8_t> closed;        ///< for each piece: no edge is left over
  std::vector<std::uint8_t> unorientable;  ///< for each piece: whether one of its patches is
  std::int64_t walls = 0;                  ///< triangles that are left out, because they are no part of the outer hull

  std::size_t size() const { return closed.size(); }
};

/// Where the borders of a piece do not cancel as they are, patches are turned (`patches.turn`): the outer hull
/// outwards, and what is no part of it is left out of the sign (outer_hull.h). For a wall between two rooms that is
/// there once does not separate inside from outside, and three patches meet at its edges: no turn of it makes them
/// cancel, and the sum of what is left over is the same for some turns of whole rooms. Such walls would disturb the
/// winding number: beside one that looks away it is 1/2 too low, and less still if more walls behind it do. So what
/// cannot be reached from outside is inside, also what was a cavity if a wall joins it to the hull.
///
/// If there is no hull that is a solid, with borders that all cancel, the choice is greedy (greedy_turns.h): of two
/// patches with a common border, most of its edges should cancel. If that makes the sum of what is left over smaller,
/// the patches are turned so, and the majority of the triangles stays; else all do. If some edges are left over then,
/// patches are left out that do not cancel there, the small ones first; but only if all cancels without them, what
/// stays is a solid, and it is most of the piece: so a hole that is filled twice is filled once. A piece with an
/// unorientable patch stays too.
Pieces find_pieces(MeshView mesh, const MeshEdges& edges, Patches& patches);

}  // namespace standoff
