// SPDX-License-Identifier: Apache-2.0
// The samples as the CPU kernels see them: bricks of 16x16x16 samples, in blocks of 4x2x2, one block per wide register.
#pragma once

#include <cstdint>

#include "field/lattice.h"

namespace standoff::cpu {

inline constexpr int kBrickTiles = 8;
inline constexpr int kLanes = 16;
inline constexpr int kBlockX = 4, kBlockY = 2, kBlockZ = 2;
inline constexpr int kBlocksX = kBrickSide / kBlockX, kBlocksY = kBrickSide / kBlockY, kBlocksZ = kBrickSide / kBlockZ;
inline constexpr int kBlocks = kBlocksX * kBlocksY * kBlocksZ;

/// Block (bx,by,bz) of a brick; x fastest.
constexpr int block_index(int bx, int by, int bz) { return bx + kBlocksX * (by + kBlocksY * bz); }

/// Sixteen blocks that lie together, 2x4x2 of them, and sixteen such clumps to a brick.
inline constexpr int kClumps = kBlocks / kLanes;
constexpr int block_of_clump(int clump, int lane) {
  return block_index(2 * (clump & 1) + (lane & 1), 4 * (clump >> 1 & 1) + (lane >> 1 & 3),
                     2 * (clump >> 2) + (lane >> 3));
}
static_assert(kLanes == 16 && kClumps == 16 && kBlocksX == 4 && kBlocksY == 8 && kBlocksZ == 8);

/// The shared lattice, and what wide registers load: coordinates of a brick's samples and blocks relative to its
/// centre.
struct BlockLattice : Lattice {
  std::int64_t bricks[3];
  float inverse_spacing[3];               ///< 1 / grid units
  float block_radius;                     ///< half the diagonal of a block, grid units
  float clump_radius;                     ///< of a clump
  alignas(64) float x[kBlocksX][kLanes];  ///< sample coordinates, by block column
  alignas(64) float y[kBlocksY][kLanes];
  alignas(64) float z[kBlocksZ][kLanes];
  alignas(64) float clump_centers[3][kClumps];
  alignas(64) float block_centers[kClumps][3][kLanes];

  std::int64_t brick_count() const { return bricks[0] * bricks[1] * bricks[2]; }
};

/// Requires a valid grid and a positive thickness.
BlockLattice make_block_lattice(const Grid& grid, double thickness);

/// A brick and its centre, grid units.
struct Brick {
  std::int64_t at[3];
  double center[4];  // the fourth is zero: loaded as one wide register
};

Brick brick_at(const BlockLattice& lattice, std::int64_t index);

}  // namespace standoff::cpu
