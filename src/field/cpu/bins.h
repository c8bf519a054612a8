// SPDX-License-Identifier: Apache-2.0
// Thin bands: sorts triangles into the bricks that they may reach, by counting.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
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

/// Sorts the job's triangles into the bricks within reach of them, batch by batch in brick order, ascending in each
/// brick. Each batch holds at most max(most_refs, the fullest brick) indices.
class BinBatches {
 public:
  /// Counts the triangles of each brick. Like next(), it runs on the threads of the calling TBB arena and may throw
  /// Error{interrupted}.
  BinBatches(const Job& job, const BlockLattice& lattice, std::int64_t most_refs, Reach reach = Reach::distance);
  BinBatches(const BinBatches&) = delete;
  BinBatches& operator=(const BinBatches&) = delete;
  ~BinBatches();

  /// The current batch; it has no bricks before the first call of next().
  const Bins& bins() const { return bins_; }
  /// Replaces the batch by the next one; false if there is none.
  bool next();

 private:
  class Binning;
  std::int64_t chunk_begin(std::int64_t chunk) const;

  const Job& job_;
  std::unique_ptr<const Binning> binning_;
  std::int64_t most_refs_, bricks_, chunks_;
  std::vector<std::uint32_t> keys_;                 // by triangle
  std::vector<std::vector<std::uint32_t>> counts_;  // by chunk of triangles, by brick; later places in a batch
  Bins bins_;
};

/// Calls use(bins) for each batch.
void for_each_batch(const Job& job, const BlockLattice& lattice, std::int64_t most_refs,
                    const std::function<void(const Bins&)>& use, Reach reach = Reach::distance);

/// Bytes that for_each_batch may hold if each brick has at most `most_refs` triangles.
std::int64_t bins_scratch_bytes(std::int64_t triangles, const BlockLattice& lattice, std::int64_t most_refs,
                                int threads);

}  // namespace standoff::cpu
