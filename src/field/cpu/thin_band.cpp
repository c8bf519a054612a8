// SPDX-License-Identifier: Apache-2.0
#include "field/cpu/thin_band.h"

#include <tbb/parallel_for.h>

#include <algorithm>

#include "core/threads.h"
#include "field/cpu/bins.h"
#include "field/cpu/brick_gather.h"

namespace standoff::cpu {
namespace {

class ThinBand final : public LayerGather {
 public:
  ThinBand(const Job& job, const BlockLattice& lattice, const Kernels& kernels)
      : job_(job), lattice_(lattice), kernels_(kernels), batches_(job, lattice, most_refs(job.triangle_count())) {}

  // Batches end where memory ends, layers where they do.
  void gather(const BrickLayers& layers, Sink& sink) override {
    const std::int64_t of_layer = lattice_.bricks[0] * lattice_.bricks[1], end = of_layer * layers.end;
    for (std::int64_t first = of_layer * layers.begin; first < end;) {
      const Bins& bins = batches_.bins();
      if (first == bins.end_brick()) batches_.next();
      const std::int64_t last = std::min(end, bins.end_brick());
      tbb::parallel_for(first, last, [&](std::int64_t brick) { gather_brick(brick, sink); });
      first = last;
    }
  }

  Counts counts() override {
    Counts counts;
    states_.for_each([&](const BrickState& state) {
      counts.samples_examined += state.samples_examined;
      counts.samples_band += state.samples_band;
    });
    return counts;
  }

 private:
  void gather_brick(std::int64_t n, Sink& sink) {
    const auto refs = batches_.bins().of(n - batches_.bins().first_brick);
    if (!refs.empty()) {
      BrickState& state = states_.local();
      const Brick brick = brick_at(lattice_, n);
      kernels_.clear(sink.with_nearest(), state);
      kernels_.gather_band(lattice_, brick, candidates_of(job_, refs), sink.with_nearest(), state);
      write_brick(lattice_, brick, kernels_, state, sink);
    }
    job_.progress.advance();
  }

  const Job& job_;
  const BlockLattice& lattice_;
  const Kernels& kernels_;
  BinBatches batches_;
  PerThread<BrickState> states_;
};

}  // namespace

std::unique_ptr<LayerGather> thin_band(const Job& job, const BlockLattice& lattice, const Kernels& kernels) {
  return std::make_unique<ThinBand>(job, lattice, kernels);
}

std::int64_t thin_scratch_bytes(std::int64_t triangles, const BlockLattice& lattice, int threads) {
  return bins_scratch_bytes(triangles, lattice, most_refs(triangles), threads) +
         static_cast<std::int64_t>(sizeof(BrickState)) * threads;
}

}  // namespace standoff::cpu
