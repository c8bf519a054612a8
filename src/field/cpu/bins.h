// SPDX-License-Identifier: Apache-2.0
// Which triangles each brick has to look at: a counting sort of triangles into bricks.
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

/// Triangle indices sorted by brick. Bricks [first_brick, first_brick + bricks()) only: where all triangles of all
/// bricks would take too much memory, they come in batches.
class Bins {
 public:
  std::int64_t first_brick = 0;
  std::vector<std::uint32_t> start = {0};  ///< of each brick in refs, and the end
  std::vector<std::uint32_t> refs;

  std::int64_t bricks() const { return static_cast<std::int64_t>(start.size()) - 1; }
  std::int64_t end_brick() const { return first_brick + bricks(); }
  std::span<const std::uint32_t> of(std::int64_t n) const {
    return std::span(refs).subspan(start[n], start[n + 1] - start[n]);
  }
};

/// Which bricks a triangle is sorted into.
enum class Reach {
  distance,  ///< those that may hold samples within the thickness of it
  box,       ///< those that may hold samples of its box grown by the thickness
};

/// Indices that a method holds at once: 64 MiB of them, or as many as there are triangles.
inline std::int64_t most_refs(std::int64_t triangles) {
  return std::max<std::int64_t>(triangles, std::int64_t{16} << 20);
}

/// Sorts the job's triangles into the bricks within reach of them, batch by batch in brick order, ascending in each
/// brick. Each batch holds at most max(most_refs, the fullest brick) indices.
class BinBatches {
 public:
  /// Counts them. Runs on the threads of the calling TBB arena, as next(). Both throw Error{interrupted}.
  BinBatches(const Job& job, const BlockLattice& lattice, std::int64_t most_refs, Reach reach = Reach::distance);
  BinBatches(const BinBatches&) = delete;
  BinBatches& operator=(const BinBatches&) = delete;
  ~BinBatches();

  /// Of no bricks before the first batch.
  const Bins& bins() const { return bins_; }
  /// Makes the next batch in the place of the last one; false after that.
  bool next();

 private:
  class Binning;
  std::int64_t chunk_begin(std::int64_t chunk) const;

  const Job& job_;
  std::unique_ptr<const Binning> binning_;
  std::int64_t most_refs_, bricks_, chunks_;
  std::vector<std::uint32_t> keys_;                 // by triangle
  std::vector<std::vector<std::uint32_t>> counts_;  // by chunk of triangles, then by brick: then places in a batch
  Bins bins_;
};

/// Hands all of them to `use`.
void for_each_batch(const Job& job, const BlockLattice& lattice, std::int64_t most_refs,
                    const std::function<void(const Bins&)>& use, Reach reach = Reach::distance);

/// Bytes that for_each_batch may hold, each brick having at most `most_refs` triangles.
std::int64_t bins_scratch_bytes(std::int64_t triangles, const BlockLattice& lattice, std::int64_t most_refs,
                                int threads);

}  // namespace standoff::cpu
