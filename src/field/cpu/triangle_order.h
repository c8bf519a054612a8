// SPDX-License-Identifier: Apache-2.0
// Orders of triangles in which neighbours are near each other: what packs of sixteen of them are cut from.
#pragma once

#include <cstdint>
#include <vector>

#include "field/backend.h"

namespace standoff::cpu {

/// The mesh indices of a job's triangles along a Morton curve: quick to make, for a hierarchy that serves one field. As
/// those below, the same for any number of threads. Runs on the threads of the calling TBB arena.
std::vector<std::uint32_t> morton_order(const Job& job);

/// The same by halving: all triangles are split across the longest side of their centers' box into two halves of whole
/// packs, the halves again, and so on down to single packs. That takes longer. The packs have tighter
/// boxes, and a search for one point visits half as many: for a hierarchy that is asked many times.
std::vector<std::uint32_t> halving_order(const Job& job);

}  // namespace standoff::cpu
