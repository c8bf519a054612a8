// SPDX-License-Identifier: Apache-2.0
// The lattice that kernels read, and the choice of kernels.
#include "field/cpu/kernels.h"

#include <cmath>

#include "field/cpu/regions.h"
#include "simd/dispatch.h"

namespace standoff::cpu {

BlockLattice make_block_lattice(const Grid& grid, double thickness) {
  BlockLattice lattice{};
  static_cast<Lattice&>(lattice) = make_lattice(grid, thickness);
  for (int axis = 0; axis < 3; ++axis) {
    lattice.bricks[axis] = (lattice.size[axis] + kBrickSide - 1) / kBrickSide;
    lattice.inverse_spacing[axis] = static_cast<float>(1 / lattice.unit[axis]);
  }
  for (int lane = 0; lane < kLanes; ++lane) {
    const int lx = lane % kBlockX, ly = lane / kBlockX % kBlockY, lz = lane / (kBlockX * kBlockY);
    for (int b = 0; b < kBlocksX; ++b) lattice.x[b][lane] = lattice.coordinate[0][b * kBlockX + lx];
    for (int b = 0; b < kBlocksY; ++b) lattice.y[b][lane] = lattice.coordinate[1][b * kBlockY + ly];
    for (int b = 0; b < kBlocksZ; ++b) lattice.z[b][lane] = lattice.coordinate[2][b * kBlockZ + lz];
  }
  // The middle of `count` samples from sample `first` on, relative to the brick's centre.
  const auto middle = [&](int first, int count, int axis) {
    return static_cast<float>((first + count / 2.0 - kBrickSide / 2.0) * lattice.unit[axis]);
  };
  const auto radius = [&](int x, int y, int z) {
    const Vec3 unit{lattice.unit[0], lattice.unit[1], lattice.unit[2]};
    return static_cast<float>(length(unit * Vec3{(x - 1) / 2.0, (y - 1) / 2.0, (z - 1) / 2.0}));
  };
  constexpr int kBlockSide[3] = {kBlockX, kBlockY, kBlockZ}, kClumpSide[3] = {2 * kBlockX, 4 * kBlockY, 2 * kBlockZ};
  for (int clump = 0; clump < kClumps; ++clump)
    for (int axis = 0; axis < 3; ++axis) {
      for (int lane = 0; lane < kLanes; ++lane) {
        const int block = block_of_clump(clump, lane);
        const int at[3] = {block % kBlocksX, block / kBlocksX % kBlocksY, block / (kBlocksX * kBlocksY)};
        lattice.block_centers[clump][axis][lane] = middle(at[axis] * kBlockSide[axis], kBlockSide[axis], axis);
        if (lane == 0) lattice.clump_centers[axis][clump] = middle(at[axis] * kBlockSide[axis], kClumpSide[axis], axis);
      }
    }
  lattice.region_slack = region_slack(lattice);
  lattice.block_radius = radius(kBlockX, kBlockY, kBlockZ);
  lattice.clump_radius = radius(kClumpSide[0], kClumpSide[1], kClumpSide[2]);
  return lattice;
}

Brick brick_at(const BlockLattice& lattice, std::int64_t index) {
  const std::int64_t bx = lattice.bricks[0], by = lattice.bricks[1];
  const std::int64_t at[3] = {index % bx, index / bx % by, index / (bx * by)};
  const Triple<double> center = cell_center<kBrickSide>(lattice, at[0], at[1], at[2]);
  return {{at[0], at[1], at[2]}, {center.x, center.y, center.z, 0}};
}

const Kernels& kernels_for(Simd simd) {
  static const Dispatch<Kernels> kernels;
  return kernels.of(simd, "compute");
}

}  // namespace standoff::cpu
