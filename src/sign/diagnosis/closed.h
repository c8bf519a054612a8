// SPDX-License-Identifier: Apache-2.0
// Two quick passes that spare most meshes a diagnosis: whether a mesh is closed, and whether it faces outwards.
#pragma once

#include <cstdint>
#include <span>

#include "standoff/mesh.h"

namespace standoff {

/// A mesh is closed if the edges of its triangles cancel. Vertices count by position, so a mesh need not be welded.
/// Edges of length 0 do not count. A sum of random numbers decides (closed.cpp): a closed mesh is always recognised,
/// and an open mesh is taken for a closed one with a probability of 2^-63, unless it was made for the purpose.
struct Closed {
  bool oriented = false;    ///< each edge is used as often in one direction as in the other: w is an integer everywhere
  bool unoriented = false;  ///< each edge is used an even number of times: the parity of crossings is well defined
};

/// The most that is_closed() holds.
inline std::int64_t closed_bytes(std::int64_t triangles) { return 16 * triangles; }

/// Requires a valid mesh. Runs on the threads of the calling TBB arena.
Closed is_closed(MeshView mesh);

/// Whether the edges of some triangles of a mesh and of those that replace them in another one cancel: then is_closed()
/// says the same of both meshes, which have all other triangles in common. Looks at these triangles alone, which must
/// be valid.
Closed same_edges(MeshView a, std::span<const std::uint32_t> of_a, MeshView b, std::span<const std::uint32_t> of_b);

/// Whether no part of a closed mesh is inside out. True only if the normals of each set of triangles that share
/// vertices, by index, cancel, as in a closed set, and its volume is positive. Sets without area do not count, but some
/// set must have one. Does not depend on the number of threads. Requires a valid mesh. Runs on the threads of the
/// calling TBB arena.
bool faces_outwards(MeshView mesh);

/// The most that faces_outwards() holds, for a mesh without vertices that no triangle uses.
std::int64_t outward_bytes(std::int64_t triangles);

}  // namespace standoff
