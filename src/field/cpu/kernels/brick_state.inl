// SPDX-License-Identifier: Apache-2.0
// The samples of a brick while triangles are gathered into it: cleared, lowered, and written into tiles.
#pragma once

#include "field/cpu/kernels/target.inl"

namespace standoff::cpu::STANDOFF_TARGET {
namespace {

void clear(bool with_nearest, BrickState& state) {
  const WideFloat infinity(__builtin_inff());
  for (auto& block : state.distance_sq) infinity.store(block);
  if (!with_nearest) return;
  const WideUint none(kNoTriangle);
  for (auto& block : state.nearest) none.store(block);
}

// Lowers the distances of a block's samples to those of a triangle; of equally near ones the lowest index counts.
template <bool kNearest>
STANDOFF_INLINE void lower(BrickState& state, int block, const WideFloat& distance_sq, std::uint32_t index) {
  const WideFloat before = WideFloat::load(state.distance_sq[block]);
  if constexpr (kNearest) {
    const WideUint mine(index), theirs = WideUint::load(state.nearest[block]);
    const Mask nearer = less(distance_sq, before) | (equal(distance_sq, before) & less(mine, theirs));
    select(nearer, mine, theirs).store(state.nearest[block]);
  }
  min(distance_sq, before).store(state.distance_sq[block]);
}

// Bits of the block's samples that lie inside the grid, for bricks the grid's far faces cut.
STANDOFF_INLINE std::uint32_t inside_bits(const int (&size)[3], int bx, int by, int bz) {
  std::uint32_t bits = 0;
  for (int lane = 0; lane < kLanes; ++lane)
    if (bx * kBlockX + lane % kBlockX < size[0] && by * kBlockY + lane / kBlockX % kBlockY < size[1] &&
        bz * kBlockZ + lane / (kBlockX * kBlockY) < size[2])
      bits |= 1u << lane;
  return bits;
}

unsigned band_tiles(const BlockLattice& lattice, const Brick& brick, BrickState& state) {
  const WideFloat limit_sq(lattice.thickness_sq);
  const int size[3] = {inside<kBrickSide>(lattice, brick.at, 0), inside<kBrickSide>(lattice, brick.at, 1),
                       inside<kBrickSide>(lattice, brick.at, 2)};
  const bool whole = size[0] == kBrickSide && size[1] == kBrickSide && size[2] == kBrickSide;
  unsigned tiles = 0;
  for (int block = 0; block < kBlocks; ++block) {
    std::uint32_t band = ~less(limit_sq, WideFloat::load(state.distance_sq[block])).to_bits() & 0xffffu;
    if (band == 0) continue;
    const int bx = block % kBlocksX, by = block / kBlocksX % kBlocksY, bz = block / (kBlocksX * kBlocksY);
    if (!whole) band &= inside_bits(size, bx, by, bz);
    if (band == 0) continue;
    tiles |= 1u << (bx / (kBlocksX / 2) + 2 * (by / (kBlocksY / 2)) + 4 * (bz / (kBlocksZ / 2)));
    state.samples_band += __builtin_popcount(band);
  }
  return tiles;
}

// Writes those samples of a block that lie inside the grid, in rows of four.
template <class T>
STANDOFF_INLINE void copy_block(const T* block, int x, int y, int z, const TileTarget& target, T* out) {
  const bool whole = x + kBlockX <= target.size.x && y + kBlockY <= target.size.y && z + kBlockZ <= target.size.z;
  for (int row = 0; row < kBlockY * kBlockZ; ++row) {
    const int ry = y + row % kBlockY, rz = z + row / kBlockY;
    T* to = out + x + target.row * ry + target.slice * rz;
    if (whole)
      __builtin_memcpy(to, block + kBlockX * row, kBlockX * sizeof(T));
    else if (ry < target.size.y && rz < target.size.z)
      for (int i = 0; i < kBlockX && x + i < target.size.x; ++i) to[i] = block[kBlockX * row + i];
  }
}

void write_tile(const BlockLattice& lattice, const BrickState& state, int tile, const TileTarget& target) {
  const WideFloat limit_sq(lattice.thickness_sq), limit(lattice.thickness_world), unscale(lattice.unscale);
  constexpr int nx = kBlocksX / 2, ny = kBlocksY / 2, nz = kBlocksZ / 2;
  const int x0 = (tile & 1) * nx, y0 = (tile >> 1 & 1) * ny, z0 = (tile >> 2 & 1) * nz;
  for (int bz = 0; bz < nz; ++bz)
    for (int by = 0; by < ny; ++by)
      for (int bx = 0; bx < nx; ++bx) {
        const int block = block_index(x0 + bx, y0 + by, z0 + bz);
        const WideFloat squared = WideFloat::load(state.distance_sq[block]);
        alignas(64) float values[kLanes];
        min(sqrt(squared) * unscale, limit).store(values);
        copy_block(values, bx * kBlockX, by * kBlockY, bz * kBlockZ, target, target.values);
        if (!target.nearest) continue;
        alignas(64) std::uint32_t nearest[kLanes];
        select(less(limit_sq, squared), WideUint(kNoTriangle), WideUint::load(state.nearest[block])).store(nearest);
        copy_block(nearest, bx * kBlockX, by * kBlockY, bz * kBlockZ, target, target.nearest);
      }
}

}  // namespace
}  // namespace standoff::cpu::STANDOFF_TARGET
