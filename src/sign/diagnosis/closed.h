// SPDX-License-Identifier: Apache-2.0
// Whether a mesh is closed: the edges of its triangles cancel.
#pragma once

#include <cstdint>

#include "standoff/mesh.h"

namespace standoff {

/// Vertices count by position, so a mesh need not be welded. Edges of length 0 do not count. A sum of random numbers
/// decides (closed.cpp): a closed mesh is always recognised, and a mesh that is not closed is taken for a closed one
/// with a probability of 2^-63, unless it was made for the purpose.
struct Closed {
  bool oriented = false;    ///< each edge is used as often in one direction as in the other: w is an integer everywhere
  bool unoriented = false;  ///< each edge is used an even number of times: the parity of crossings is well defined
};

/// What is_closed() holds at most.
inline std::int64_t closed_bytes(std::int64_t triangles) { return 16 * triangles; }

/// Requires a valid mesh. Runs on the threads of the calling TBB arena.
Closed is_closed(MeshView mesh);

}  // namespace standoff
