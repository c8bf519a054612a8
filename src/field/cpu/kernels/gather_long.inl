// SPDX-License-Identifier: Apache-2.0
// One long triangle against the samples of a brick, by lines that are set up in double (geometry/triangle_frame.h).
#pragma once

#include "field/cpu/kernels/brick_state.inl"
#include "field/cpu/kernels/triangle_frames.inl"
#include "geometry/triangle_frame.h"

namespace standoff::cpu::STANDOFF_TARGET {
namespace {

STANDOFF_INLINE WidePoint block_samples(const BlockLattice& lattice, int block) {
  return {WideFloat::load(lattice.x[block % kBlocksX]), WideFloat::load(lattice.y[block / kBlocksX % kBlocksY]),
          WideFloat::load(lattice.z[block / (kBlocksX * kBlocksY)])};
}

// The numbers of block_of_clump.
struct ClumpBlocks {
  std::uint8_t block[kClumps][kLanes];
  constexpr ClumpBlocks() : block() {
    for (int clump = 0; clump < kClumps; ++clump)
      for (int lane = 0; lane < kLanes; ++lane)
        block[clump][lane] = static_cast<std::uint8_t>(block_of_clump(clump, lane));
  }
};
constexpr ClumpBlocks kClumpBlocks;

// Functions that are not inlined, which saves minutes of compilation: which of sixteen points are nearer than a limit,
// and the distances of a block that lies in both halves of the triangle.
__attribute__((noinline)) std::uint32_t points_within(const TriangleLines<WideFloat>& lines, const WidePoint& points,
                                                      float limit_sq) {
  return less(distance_sq(lines, points), WideFloat(limit_sq)).to_bits();
}
__attribute__((noinline)) WideFloat distance_sq_in_both(const TriangleLines<WideFloat>& lines,
                                                        const WidePoint& points) {
  return distance_sq(lines, points);
}

// Chooses clumps of blocks, and blocks in these, by the exact distances of their centres. Most blocks lie wholly on one
// side of the triangle's altitude: half of its lines are enough for these.
template <bool kNearest>
STANDOFF_INLINE void gather_long(const BlockLattice& lattice, const Brick& brick, const Candidates& c,
                                 std::uint32_t index, BrickState& state) {
  const TriangleLines<WideFloat> lines = make_lines<WideFloat>(double_frame(lattice, brick, c, index));
  const auto within = [&](float radius) __attribute__((always_inline)) {
    const float reach = (lattice.thickness + radius) * (1 + kSlackRatio) + kSlack;
    return reach * reach;
  };
  const float reach_sq = within(lattice.block_radius);
  const WideFloat beside(lattice.block_radius * (1 + kSlackRatio) + kSlack);
  std::uint32_t clumps = points_within(lines, load_points(lattice.clump_centers), within(lattice.clump_radius));
  for (; clumps; clumps &= clumps - 1) {
    const int clump = __builtin_ctz(clumps);
    const WidePoint center = load_points(lattice.block_centers[clump]);
    std::uint32_t near_blocks = points_within(lines, center, reach_sq);
    const WideFloat q = evaluate(lines.q, center);
    const std::uint32_t left = less(q, -beside).to_bits(), right = less(beside, q).to_bits();
    state.samples_examined += std::int64_t{kLanes} * __builtin_popcount(near_blocks);
    for (std::uint32_t halved = near_blocks & (left | right); halved; halved &= halved - 1) {
      const int n = __builtin_ctz(halved), block = kClumpBlocks.block[clump][n];
      const HalfLines<WideFloat>& half = left >> n & 1 ? lines.left : lines.right;
      lower<kNearest>(state, block, distance_sq_in_half(lines, half, block_samples(lattice, block)), index);
    }
    for (near_blocks &= ~(left | right); near_blocks; near_blocks &= near_blocks - 1) {
      const int block = kClumpBlocks.block[clump][__builtin_ctz(near_blocks)];
      lower<kNearest>(state, block, distance_sq_in_both(lines, block_samples(lattice, block)), index);
    }
  }
}

}  // namespace
}  // namespace standoff::cpu::STANDOFF_TARGET
