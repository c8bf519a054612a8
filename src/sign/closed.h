// SPDX-License-Identifier: Apache-2.0
// Whether a mesh is closed: the edges of its triangles cancel.
#pragma once

#include "standoff/mesh.h"

namespace standoff {

/// Vertices count by position, so a mesh need not be welded. Edges of length 0 do not count. Sums of 128 random bits
/// per edge decide: a closed mesh is always recognised; a mesh that is not closed is taken for a closed one with a
/// probability of 2^-128.
struct Closed {
  bool oriented = false;    ///< each edge is used as often in one direction as in the other: w is an integer everywhere
  bool unoriented = false;  ///< each edge is used an even number of times: the parity of crossings is well defined
};

/// Requires a valid mesh. Runs on the threads of the calling TBB arena.
Closed is_closed(MeshView mesh);

}  // namespace standoff
