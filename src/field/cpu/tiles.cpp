// SPDX-License-Identifier: Apache-2.0
#include "field/cpu/tiles.h"

#include "field/cpu/thick_band.h"
#include "field/cpu/thin_band.h"

namespace standoff::cpu {

Counts run_tiles(const Job& job, Sink& sink) {
  const BlockLattice lattice = make_block_lattice(job.grid, job.thickness);
  const Kernels& kernels = kernels_for(job.simd);
  job.progress.stage("gather", lattice.brick_count(), 0.2, 1);
  return is_thin(job.grid, job.thickness) ? gather_thin(job, lattice, kernels, sink)
                                          : gather_thick(job, lattice, kernels, sink);
}

std::string tiles_device(Simd requested) { return kernels_for(requested).name; }

std::int64_t tiles_scratch_bytes(std::int64_t triangles, const Grid& grid, double thickness, int threads) {
  const BlockLattice lattice = make_block_lattice(grid, thickness);
  return is_thin(grid, thickness) ? thin_scratch_bytes(triangles, lattice, threads)
                                  : thick_scratch_bytes(triangles, lattice, threads);
}

}  // namespace standoff::cpu
