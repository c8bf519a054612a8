// SPDX-License-Identifier: Apache-2.0
// The kernel for narrow bands: each triangle against the blocks of samples that its box, grown by the thickness,
// reaches.
#pragma once

#include "field/cpu/kernels/brick_state.inl"
#include "field/cpu/kernels/gather_long.inl"
#include "field/cpu/kernels/triangle_frames.inl"

namespace standoff::cpu::STANDOFF_TARGET {
namespace {

// The blocks that hold samples within the thickness of each triangle's box, per axis: first > last for none.
struct BlockRanges {
  alignas(64) int first[3][kLanes];
  alignas(64) int last[3][kLanes];
};

STANDOFF_INLINE void block_ranges(const BlockLattice& lattice, const Group& group, BlockRanges& ranges) {
  constexpr int shift[3] = {2, 1, 1};
  static_assert(1 << shift[0] == kBlockX && 1 << shift[1] == kBlockY && 1 << shift[2] == kBlockZ);
  const WideFloat zero(0), side(kBrickSide), middle((kBrickSide - 1) / 2.0f), slack(kSlack), one(1);
  for (int axis = 0; axis < 3; ++axis) {
    const WideFloat a = component(group.corner[0], axis), b = component(group.corner[1], axis),
                    c = component(group.corner[2], axis);
    const WideFloat low = min(a, min(b, c)), high = max(a, max(b, c));
    const WideFloat reach(lattice.thickness), inverse(lattice.inverse_spacing[axis]);
    // The first sample at or above `low - reach`, and one past the last at or below `high + reach`.
    const WideFloat begin = fma(low - (reach + slack), inverse, middle) + (one - slack);
    const WideFloat end = fma(high + (reach + slack), inverse, middle) + (one + slack);
    store_truncated(ranges.first[axis], max(zero, min(begin, side)));
    store_truncated(ranges.last[axis], max(zero, min(end, side)));
    for (int lane = 0; lane < kLanes; ++lane) {
      ranges.first[axis][lane] = ranges.first[axis][lane] >> shift[axis];
      ranges.last[axis][lane] = (ranges.last[axis][lane] - 1) >> shift[axis];
    }
  }
}

// A short triangle against the blocks in its grown box, kCount blocks wide from block x0 on: the count is a constant so
// that the innermost loop has no branch to mispredict.
template <bool kNearest, int kCount>
STANDOFF_INLINE void gather_rows(const BlockLattice& lattice, const BlockRanges& ranges,
                                 const TriangleFrame<WideFloat>& f, int lane, std::uint32_t index, BrickState& state) {
  const int x0 = ranges.first[0][lane], y0 = ranges.first[1][lane], y1 = ranges.last[1][lane],
            z0 = ranges.first[2][lane], z1 = ranges.last[2][lane];
  for (int bz = z0; bz <= z1; ++bz) {
    const WideFloat z = WideFloat::load(lattice.z[bz]);
    const WideFloat qz = fma(z, f.q.g.z, f.q.c), yz = fma(z, f.y.g.z, f.y.c), zz = fma(z, f.z.g.z, f.z.c);
    for (int by = y0; by <= y1; ++by) {
      const WideFloat y = WideFloat::load(lattice.y[by]);
      const WideFloat qy = fma(y, f.q.g.y, qz), yy = fma(y, f.y.g.y, yz), zy = fma(y, f.z.g.y, zz);
      const int row = block_index(x0, by, bz);
#pragma GCC unroll 4
      for (int n = 0; n < kCount; ++n) {
        const WideFloat x = WideFloat::load(lattice.x[x0 + n]);
        const WideFloat d = frame_distance_sq(f, fma(x, f.q.g.x, qy), fma(x, f.y.g.x, yy), fma(x, f.z.g.x, zy));
        lower<kNearest>(state, row + n, d, index);
      }
    }
  }
}

template <bool kNearest>
STANDOFF_INLINE void gather_short(const BlockLattice& lattice, const BlockRanges& ranges, const FrameLanes& frames,
                                  int lane, std::uint32_t index, BrickState& state) {
  const int nx = ranges.last[0][lane] - ranges.first[0][lane] + 1,
            ny = ranges.last[1][lane] - ranges.first[1][lane] + 1,
            nz = ranges.last[2][lane] - ranges.first[2][lane] + 1;
  if (nx <= 0 || ny <= 0 || nz <= 0) return;
  const TriangleFrame<WideFloat> f = frame_of_lane<WideFloat>(frames, static_cast<std::uint32_t>(lane));
  static_assert(kBlocksX == 4);
  if (nx == 1)
    gather_rows<kNearest, 1>(lattice, ranges, f, lane, index, state);
  else if (nx == 2)
    gather_rows<kNearest, 2>(lattice, ranges, f, lane, index, state);
  else if (nx == 3)
    gather_rows<kNearest, 3>(lattice, ranges, f, lane, index, state);
  else
    gather_rows<kNearest, 4>(lattice, ranges, f, lane, index, state);
  state.samples_examined += std::int64_t{kLanes} * nx * ny * nz;
}

template <bool kNearest>
void gather_band(const BlockLattice& lattice, const Brick& brick, const Candidates& c, BrickState& state) {
  Group group;
  BlockRanges ranges;
  FrameLanes frames;
  for (std::int64_t first = 0; first < c.count; first += kLanes) {
    load_group(lattice, brick, c, first, group);
    block_ranges(lattice, group, ranges);
    const std::uint32_t is_long = long_lanes(group);
    store_frames(make_frames(group), frames);
    const int used = c.count - first < kLanes ? static_cast<int>(c.count - first) : kLanes;
    for (int lane = 0; lane < used; ++lane) {
      if (is_long >> lane & 1)
        gather_long<kNearest>(lattice, brick, c, group.index[lane], state);
      else
        gather_short<kNearest>(lattice, ranges, frames, lane, group.index[lane], state);
    }
  }
}

void gather_band_any(const BlockLattice& lattice, const Brick& brick, const Candidates& c, bool with_nearest,
                     BrickState& state) {
  if (with_nearest)
    gather_band<true>(lattice, brick, c, state);
  else
    gather_band<false>(lattice, brick, c, state);
}

}  // namespace
}  // namespace standoff::cpu::STANDOFF_TARGET
