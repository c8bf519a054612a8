// SPDX-License-Identifier: Apache-2.0
#include "field/cpu/thin_band.h"

#include <tbb/parallel_for.h>

#include "core/per_thread.h"
#include "field/cpu/bins.h"
#include "field/cpu/brick_gather.h"

namespace standoff::cpu {

Counts gather_thin(const Job& job, const BlockLattice& lattice, const Kernels& kernels, Sink& sink) {
  PerThread<BrickState> states;
  for_each_batch(job, lattice, most_refs(job.triangle_count()), [&](const Bins& bins) {
    tbb::parallel_for(std::int64_t{0}, bins.bricks(), [&](std::int64_t n) {
      const auto refs = bins.of(n);
      if (!refs.empty()) {
        BrickState& state = states.local();
        const Brick brick = brick_at(lattice, bins.first_brick + n);
        kernels.clear(sink.with_nearest(), state);
        kernels.gather_band(lattice, brick, candidates_of(job, refs), sink.with_nearest(), state);
        write_brick(lattice, brick, kernels, state, sink);
      }
      job.progress.advance();
    });
  });
  Counts counts;
  states.for_each([&](const BrickState& state) {
    counts.samples_examined += state.samples_examined;
    counts.samples_band += state.samples_band;
  });
  return counts;
}

std::int64_t thin_scratch_bytes(std::int64_t triangles, const BlockLattice& lattice, int threads) {
  return bins_scratch_bytes(triangles, lattice, most_refs(triangles), threads) +
         static_cast<std::int64_t>(sizeof(BrickState)) * threads;
}

}  // namespace standoff::cpu
