// SPDX-License-Identifier: Apache-2.0
// Thin bands: sorts triangles into the bricks that they may reach, by counting.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "field/backend.h"
#include "field/cpu/kernels.h"

namespace standoff::cpu {

/// The triangles of the bricks [first_brick, first_brick + bricks()), sorted by brick. If the triangles of all bricks
/// would take too much memory, they come in batches.
class Bins {
 public:
  std::int64_t first_brick = 0;
  std::vector<std::uint32_t> start = {0};  ///< the start of each brick in refs, and the end
  std::vector<std::uint32_t> refs;

  std::int64_t bricks() const { return static_cast<std::int64_t>(start.size()) - 1; }
  std::int64_t end_brick() const { return first_brick + bricks(); }
  std::span<const std::uint32_t> of(std::int64_t n) const {
    return std::span(refs).subspan(start[n], start[n + 1] - start[n]);
  }
};

/// Which bricks a triangle is sorted into.
enum class Reach {
  distance,  ///< bricks that may hold samples within the thickness of the triangle
  box,       ///< bricks that may hold samples of its box grown by the thickness
};

/// Indices that a method holds at once: 64 MiB of them, or one per triangle if that is more.
inline std::int64_t most_refs(std::int64_t triangles) {
  return std::max<std::int64_t>(triangles, std::int64_t{16} << 20);
}

/// Sorts the job's triangles into the bricks within reach of them, and calls use(bins) batch by batch in brick order,
/// triangles ascending in each brick. Each batch holds at most max(most_refs, the fullest brick) indices, and is valid
/// until use() returns. Runs on the threads of the calling TBB arena. Throws Error{interrupted}.
void for_each_batch(const Job& job, const BlockLattice& lattice, std::int64_t most_refs,
                    const std::function<void(const Bins&)>& use, Reach reach = Reach::distance,
                    const Region* regions = nullptr);

/// The bins of all bricks; nothing if they would hold more indices than that. As for_each_batch otherwise.
std::optional<Bins> all_bins(const Job& job, const BlockLattice& lattice, std::int64_t most_refs,
                             const Region* regions);

/// Bytes that for_each_batch may hold if each brick has at most `most_refs` triangles.
std::int64_t bins_scratch_bytes(const MeshLoad& mesh, const BlockLattice& lattice, std::int64_t most_refs, int threads);

}  // namespace standoff::cpu
