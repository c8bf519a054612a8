// SPDX-License-Identifier: Apache-2.0
#include "field/cpu/tiles.h"

#include <memory>

#include "field/cpu/thick_band.h"
#include "field/cpu/thin_band.h"

namespace standoff::cpu {

namespace {

// What the job's parts have in common stays where it is while they are gathered.
class Tiles final : public LayerGather {
 public:
  explicit Tiles(const Job& job) : lattice_(make_block_lattice(job.grid, job.thickness)) {
    const Kernels& kernels = kernels_for(job.simd);
    job.progress.stage("gather", lattice_.brick_count(), 0.2, 1);
    band_ = is_thin(job.grid, job.thickness) ? thin_band(job, lattice_, kernels) : thick_band(job, lattice_, kernels);
  }

  void gather(const BrickLayers& layers, Sink& sink) override { band_->gather(layers, sink); }
  Counts counts() override { return band_->counts(); }
  std::int64_t layers() const { return lattice_.bricks[2]; }

 private:
  BlockLattice lattice_;
  std::unique_ptr<LayerGather> band_;
};

}  // namespace

Counts run_tiles(const Job& job, Sink& sink) {
  Tiles tiles(job);
  tiles.gather({0, tiles.layers()}, sink);
  return tiles.counts();
}

std::unique_ptr<LayerGather> tiles_in_layers(const Job& job) { return std::make_unique<Tiles>(job); }

std::string tiles_device(Simd requested) { return kernels_for(requested).name; }

std::int64_t tiles_scratch_bytes(std::int64_t triangles, const Grid& grid, double thickness, int threads) {
  const BlockLattice lattice = make_block_lattice(grid, thickness);
  return is_thin(grid, thickness) ? thin_scratch_bytes(triangles, lattice, threads)
                                  : thick_scratch_bytes(triangles, lattice, threads);
}

}  // namespace standoff::cpu
