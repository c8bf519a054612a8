// SPDX-License-Identifier: Apache-2.0
// Pieces: patches that border on each other at nonmanifold edges, each turned so that the borders cancel.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sign/mesh_edges.h"
#include "sign/patches.h"

namespace standoff {

/// What is turned as a whole: a patch that is closed by itself, as most are, or patches joined over nonmanifold edges
/// at which they have a border. (Two boxes that share an edge are two pieces: each cancels itself there.)
struct Pieces {
  std::vector<std::uint32_t> of;           ///< for each triangle its piece
  std::vector<std::uint8_t> closed;        ///< for each piece: no edge is left over
  std::vector<std::uint8_t> unorientable;  ///< for each piece: whether one of its patches is

  std::size_t size() const { return closed.size(); }
};

/// Turns whole patches (`patches.turn`) where that makes the sum of the weights of the boundary smaller. The choice is
/// greedy (greedy_turns.h): of two patches with a common border, most of its edges should cancel. If that is no better
/// than the patches as they are, they stay, else the majority of the triangles does. A piece with an unorientable patch
/// stays too.
Pieces find_pieces(const MeshEdges& edges, Patches& patches);

}  // namespace standoff
