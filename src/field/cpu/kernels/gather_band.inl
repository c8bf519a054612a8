// SPDX-License-Identifier: Apache-2.0
// The kernels that clear, count and write the distances of a brick; and the kernel of bins, which measures each
// triangle from the blocks of samples that its box, grown by the thickness, reaches, or that meet its region.
#pragma once

#include "field/cpu/kernels/triangle_frames.inl"
#include "field/cpu/regions.h"
#include "geometry/triangle_frame.h"

namespace standoff::cpu::STANDOFF_TARGET {
namespace {

void clear(bool with_nearest, BrickState& state) {
  const WideFloat infinity(__builtin_inff());
  for (auto& block : state.distance_sq) infinity.store(block);
  if (!with_nearest) return;
  const WideUint none(kNoTriangle);
  for (auto& block : state.nearest) none.store(block);
}

// Lowers the distances of a block's samples to the distances from a triangle; the lowest index wins a tie.
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

// Bits of the block's samples inside the grid, whose far faces may cut the brick.
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

// Writes the samples of a block that lie inside the grid, in rows of four.
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

// Long triangles are measured one by one, by lines that are set up in double (geometry/triangle_frame.h).

STANDOFF_INLINE WidePoint block_samples(const BlockLattice& lattice, int block) {
  return {WideFloat::load(lattice.x[block % kBlocksX]), WideFloat::load(lattice.y[block / kBlocksX % kBlocksY]),
          WideFloat::load(lattice.z[block / (kBlocksX * kBlocksY)])};
}

// The block numbers of each clump.
struct ClumpBlocks {
  std::uint8_t block[kClumps][kLanes];
  constexpr ClumpBlocks() : block() {
    for (int clump = 0; clump < kClumps; ++clump)
      for (int lane = 0; lane < kLanes; ++lane)
        block[clump][lane] = static_cast<std::uint8_t>(block_of_clump(clump, lane));
  }
};
constexpr ClumpBlocks kClumpBlocks;

// Two functions that are not inlined, which saves minutes of compilation: one tells which of sixteen points are nearer
// than a limit, the other measures a block that lies on both sides of the triangle's altitude.
__attribute__((noinline)) std::uint32_t points_within(const TriangleLines<WideFloat>& lines, const WidePoint& points,
                                                      float limit_sq) {
  return less(distance_sq(lines, points), WideFloat(limit_sq)).to_bits();
}
__attribute__((noinline)) WideFloat distance_sq_in_both(const TriangleLines<WideFloat>& lines,
                                                        const WidePoint& points) {
  return distance_sq(lines, points);
}

// Selects clumps of blocks, and blocks in them, by the exact distances of their centres. Most blocks lie on one side of
// the triangle's altitude: half of its lines suffice for these.
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

// Short triangles are set up sixteen at a time.

// The blocks with samples within the thickness of each triangle's box, per axis; first > last if there are none.
struct BlockRanges {
  alignas(64) int first[3][kLanes];
  alignas(64) int last[3][kLanes];
};

// How far the triangles reach beyond their boxes.
STANDOFF_INLINE WideFloat reaches(const BlockLattice& lattice, const Candidates& c, const Group& group, int axis) {
  if (!c.regions) return WideFloat(lattice.thickness);
  alignas(64) float reach[kLanes];
  for (int lane = 0; lane < kLanes; ++lane) reach[lane] = c.regions[group.index[lane]].reach[axis];
  return WideFloat::load(reach);
}

STANDOFF_INLINE void block_ranges(const BlockLattice& lattice, const Candidates& all, const Group& group,
                                  BlockRanges& ranges) {
  constexpr int shift[3] = {2, 1, 1};
  static_assert(1 << shift[0] == kBlockX && 1 << shift[1] == kBlockY && 1 << shift[2] == kBlockZ);
  const WideFloat zero(0), side(kBrickSide), middle((kBrickSide - 1) / 2.0f), slack(kSlack), one(1);
  for (int axis = 0; axis < 3; ++axis) {
    const WideFloat a = component(group.corner[0], axis), b = component(group.corner[1], axis),
                    c = component(group.corner[2], axis);
    const WideFloat low = min(a, min(b, c)), high = max(a, max(b, c));
    const WideFloat reach = reaches(lattice, all, group, axis), inverse(lattice.inverse_spacing[axis]);
    // Find the first sample at or above `low - reach`, and one past the last at or below `high + reach`.
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

// Measures a short triangle from the blocks in its grown box, which is kCount blocks wide from block x0 on: the count
// is a constant so that the innermost loop has no branch to mispredict.
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

// Where neighbours are nearer to the samples beside a triangle (docs/tiles.md, "Regions"), blocks beside it are left
// out.

// What tells the blocks that meet the regions of sixteen triangles: how far a block's centre may be from the plane, and
// how far beyond each edge's line, less the tilt times the height.
struct RegionLanes {
  alignas(64) float tilt[kLanes];
  alignas(64) float height[kLanes];
  alignas(64) float base[kLanes];
  alignas(64) float left[kLanes];
  alignas(64) float right[kLanes];
};

STANDOFF_INLINE void make_regions(const BlockLattice& lattice, const Candidates& c, const Group& group,
                                  const TriangleFrame<WideFloat>& f, RegionLanes& regions) {
  for (int lane = 0; lane < kLanes; ++lane) regions.tilt[lane] = c.regions[group.index[lane]].tilt;
  const WideFloat tilt = WideFloat::load(regions.tilt);
  const auto half = [&](int axis, int side) __attribute__((always_inline)) {
    return WideFloat(static_cast<float>(lattice.unit[axis] * (side - 1) / 2));
  };
  const WideFloat x = half(0, kBlockX), y = half(1, kBlockY), z = half(2, kBlockZ);
  // By how much a linear function may change from a block's centre to its samples.
  const auto change = [&](const WidePoint& g) __attribute__((always_inline)) {
    return fma(abs(g.x), x, fma(abs(g.y), y, abs(g.z) * z));
  };
  const WideFloat slack = sqrt(fma(tilt, tilt, WideFloat(1))) * WideFloat(lattice.region_slack);
  const WidePoint rise = f.z.g * tilt;
  const auto beyond = [&](const WidePoint& outward) __attribute__((always_inline)) {
    return max(change(outward - rise), change(outward + rise)) + slack;
  };
  (change(f.z.g) + WideFloat(lattice.thickness + kSlack)).store(regions.height);
  beyond(f.y.g * WideFloat(-1)).store(regions.base);
  beyond(f.q.g * -f.left.nx + f.y.g * f.left.ny).store(regions.left);
  beyond(f.q.g * f.right.nx + f.y.g * f.right.ny).store(regions.right);
}

// Bits of a clump's blocks that are in columns, rows or slices first to last: by clump along the axis.
template <int kCount, int kPerClump, int kShift>
struct ClumpBits {
  std::uint16_t of[kCount][kCount][kCount / kPerClump];
  constexpr ClumpBits() : of() {
    for (int first = 0; first < kCount; ++first)
      for (int last = first; last < kCount; ++last)
        for (int clump = 0; clump < kCount / kPerClump; ++clump)
          for (int lane = 0; lane < kLanes; ++lane) {
            const int at = kPerClump * clump + (lane >> kShift) % kPerClump;
            if (at >= first && at <= last) of[first][last][clump] |= static_cast<std::uint16_t>(1u << lane);
          }
  }
};
constexpr ClumpBits<kBlocksX, 2, 0> kColumnBits;
constexpr ClumpBits<kBlocksY, 4, 1> kRowBits;
constexpr ClumpBits<kBlocksZ, 2, 3> kSliceBits;

// Measures a short triangle from the blocks that meet its region, or are within the thickness if it has none.
template <bool kNearest>
STANDOFF_INLINE void gather_region(const BlockLattice& lattice, const BlockRanges& ranges, const FrameLanes& frames,
                                   const RegionLanes& regions, int lane, std::uint32_t index, BrickState& state) {
  const int x0 = ranges.first[0][lane], x1 = ranges.last[0][lane], y0 = ranges.first[1][lane],
            y1 = ranges.last[1][lane], z0 = ranges.first[2][lane], z1 = ranges.last[2][lane];
  if (x0 > x1 || y0 > y1 || z0 > z1) return;
  const TriangleFrame<WideFloat> f = frame_of_lane<WideFloat>(frames, static_cast<std::uint32_t>(lane));
  constexpr int kWord = 4;  // clumps of a word of bits
  std::uint64_t met[kClumps / kWord] = {};
  // Clumps are 2x4x2 blocks.
  const auto meet = [&](auto is_met) __attribute__((always_inline)) {
    for (int z = z0 / 2; z <= z1 / 2; ++z)
      for (int y = y0 / 4; y <= y1 / 4; ++y)
        for (int x = x0 / 2; x <= x1 / 2; ++x) {
          const int clump = x + 2 * (y + 2 * z);
          const WidePoint at = load_points(lattice.block_centers[clump]);
          const std::uint32_t bits = is_met(evaluate(f.q, at), evaluate(f.y, at), evaluate(f.z, at)).to_bits() &
                                     kColumnBits.of[x0][x1][x] & kRowBits.of[y0][y1][y] & kSliceBits.of[z0][z1][z];
          met[clump / kWord] |= std::uint64_t{bits} << (kLanes * (clump % kWord));
        }
  };
  if (regions.tilt[lane] == kNoTilt) {
    const float reach = (lattice.thickness + lattice.block_radius) * (1 + kSlackRatio) + kSlack;
    const WideFloat reach_sq(reach * reach);
    meet([&](const WideFloat& q, const WideFloat& y, const WideFloat& z)
             __attribute__((always_inline)) { return less(frame_distance_sq(f, q, y, z), reach_sq); });
  } else {
    const WideFloat down(-regions.tilt[lane]), height(regions.height[lane]), base(regions.base[lane]),
        left(regions.left[lane]), right(regions.right[lane]);
    meet([&](const WideFloat& q, const WideFloat& y, const WideFloat& z) __attribute__((always_inline)) {
      const WideFloat above = abs(z), lowered = above * down, upper_left = fma(f.left.ny, y, lowered),
                      upper_right = fma(f.right.ny, y, lowered);
      return less(above, height) & less(lowered - y, base) & less(fma(f.left.nx, -q - f.left.leg, upper_left), left) &
             less(fma(f.right.nx, q - f.right.leg, upper_right), right);
    });
  }
  for (int word = 0; word < kClumps / kWord; ++word) {
    state.samples_examined += std::int64_t{kLanes} * __builtin_popcountll(met[word]);
    for (std::uint64_t bits = met[word]; bits; bits &= bits - 1) {
      const int block = kClumpBlocks.block[kWord * word][__builtin_ctzll(bits)];
      lower<kNearest>(state, block, distance_sq(f, block_samples(lattice, block)), index);
    }
  }
}

template <bool kNearest>
void gather_band(const BlockLattice& lattice, const Brick& brick, const Candidates& c, BrickState& state) {
  Group group;
  BlockRanges ranges;
  FrameLanes frames;
  RegionLanes regions;
  for (std::int64_t first = 0; first < c.count; first += kLanes) {
    load_group(lattice, brick, c, first, group);
    block_ranges(lattice, c, group, ranges);
    const std::uint32_t is_long = long_lanes(group);
    const TriangleFrame<WideFloat> f = make_frames(group);
    store_frames(f, frames);
    if (c.regions) make_regions(lattice, c, group, f, regions);
    const int used = c.count - first < kLanes ? static_cast<int>(c.count - first) : kLanes;
    for (int lane = 0; lane < used; ++lane) {
      if (is_long >> lane & 1)
        gather_long<kNearest>(lattice, brick, c, group.index[lane], state);
      else if (c.regions)
        gather_region<kNearest>(lattice, ranges, frames, regions, lane, group.index[lane], state);
      else
        gather_short<kNearest>(lattice, ranges, frames, lane, group.index[lane], state);
    }
  }
}

}  // namespace
}  // namespace standoff::cpu::STANDOFF_TARGET
