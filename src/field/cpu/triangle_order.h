// SPDX-License-Identifier: Apache-2.0
// Orders of triangles in which neighbours are near each other: what packs of sixteen of them are cut from.
#pragma once

#include <cstdint>
#include <vector>

#include "field/backend.h"

namespace standoff::cpu {

/// The mesh indices of a job's triangles along a Morton curve: quick to make, for a hierarchy that serves one field.
/// The same for any number of threads. Runs on the threads of the calling TBB arena.
std::vector<std::uint32_t> morton_order(const Job& job);

/// The same by halving: a part is split across its longest side into halves of whole packs, each of those again, down
/// to one pack. Packs have tighter boxes, which one by one questions visit half as many of, for three times the time:
/// for a hierarchy that is asked many times.
std::vector<std::uint32_t> halving_order(const Job& job);

}  // namespace standoff::cpu
