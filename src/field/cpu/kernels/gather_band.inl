// The kernels, written once over WideFloat. Each kernels_*.cpp includes this inside the namespace of its instruction
// set, after that set's WideFloat.
//
// Only always-inlined functions of the geometry room may be called here, and nothing of the standard library: a
// function compiled for AVX-512 that the linker shares with the rest of the program would crash older processors.

// Triangles at most this long, in grid units, are set up in float, sixteen at once; longer ones in double, one by one.
// At 16 the corners lie within 40 units of the brick's centre, where float resolves 4e-6 against the promised 1.6e-5:
// the tests of exactness measure a quarter of the promise at most.
constexpr float kLongTriangle = 16;
// Shorter edges and altitudes count as zero, squared grid units: a tenth of the promised error.
constexpr float kLeastLengthSq = 1e-12f;
// What rounding may add to a box or a distance when blocks are chosen, grid units.
constexpr float kSlack = 1e-3f;

static_assert(kLanes == 16);

using WidePoint = Triple<WideFloat>;

void clear(bool with_nearest, BrickState& state) {
  const WideFloat infinity(__builtin_inff());
  for (auto& block : state.distance_sq) infinity.store(block);
  if (!with_nearest) return;
  const WideUint none(kNoTriangle);
  for (auto& block : state.nearest) none.store(block);
}

// Sixteen triangles, corners relative to the brick's centre in grid units.
struct Group {
  WidePoint corner[3];
  alignas(64) std::uint32_t index[kLanes];
};

// Loads the triangles refs[first], refs[first + 1], ...; past the end the last one again, which changes nothing.
STANDOFF_INLINE void load_group(const Lattice& lattice, const Brick& brick, const Candidates& c, std::int64_t first,
                                Group& group) {
  alignas(64) float rows[3][kLanes][4];
  for (int lane = 0; lane < kLanes; ++lane) {
    const std::int64_t n = first + lane < c.count ? first + lane : c.count - 1;
    const std::uint32_t index = c.refs[n];
    group.index[lane] = index;
    const std::uint32_t* triangle = c.triangles + 3 * std::size_t{index};
    for (int which = 0; which < 3; ++which)
      store_local(rows[which][lane], c.vertices + 3 * std::size_t{triangle[which]}, lattice.scale, brick.center);
  }
  for (int which = 0; which < 3; ++which)
    group.corner[which] = {load_column(rows[which], 0), load_column(rows[which], 1), load_column(rows[which], 2)};
}

STANDOFF_INLINE const WideFloat& component(const WidePoint& p, int axis) {
  return axis == 0 ? p.x : axis == 1 ? p.y : p.z;
}

// The blocks that hold samples within the thickness of each triangle's box, per axis: first > last for none.
struct BlockRanges {
  alignas(64) int first[3][kLanes];
  alignas(64) int last[3][kLanes];
};

// Sets the ranges and returns the longest side of each triangle's box.
STANDOFF_INLINE WideFloat block_ranges(const Lattice& lattice, const Group& group, BlockRanges& ranges) {
  constexpr int shift[3] = {2, 1, 1};
  static_assert(1 << shift[0] == kBlockX && 1 << shift[1] == kBlockY && 1 << shift[2] == kBlockZ);
  const WideFloat zero(0), side(kBrickSide), middle((kBrickSide - 1) / 2.0f), slack(kSlack), one(1);
  WideFloat longest = zero;
  for (int axis = 0; axis < 3; ++axis) {
    const WideFloat a = component(group.corner[0], axis), b = component(group.corner[1], axis),
                    c = component(group.corner[2], axis);
    const WideFloat low = min(a, min(b, c)), high = max(a, max(b, c));
    longest = max(longest, high - low);
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
  return longest;
}

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

// The frames of a group, a register per number: lane n of each belongs to triangle n.
struct FrameTable {
  alignas(64) float number[20][kLanes];
};

STANDOFF_INLINE void store_frames(const TriangleFrame<WideFloat>& f, float (*number)[kLanes]) {
  const Linear<WideFloat>* lines[3] = {&f.q, &f.y, &f.z};
  for (int n = 0; n < 3; ++n) {
    lines[n]->g.x.store(number[4 * n]);
    lines[n]->g.y.store(number[4 * n + 1]);
    lines[n]->g.z.store(number[4 * n + 2]);
    lines[n]->c.store(number[4 * n + 3]);
  }
  const HalfTriangle<WideFloat>* halves[2] = {&f.left, &f.right};
  for (int n = 0; n < 2; ++n) {
    halves[n]->leg.store(number[12 + 4 * n]);
    halves[n]->length.store(number[13 + 4 * n]);
    halves[n]->nx.store(number[14 + 4 * n]);
    halves[n]->ny.store(number[15 + 4 * n]);
  }
}

// One triangle's frame in all lanes.
// The frame whose n-th number is number(n), in the order of store_frames.
template <class F, class Number>
STANDOFF_INLINE TriangleFrame<F> frame_from(Number number) {
  return {{{number(0), number(1), number(2)}, number(3)},
          {{number(4), number(5), number(6)}, number(7)},
          {{number(8), number(9), number(10)}, number(11)},
          {number(12), number(13), number(14), number(15)},
          {number(16), number(17), number(18), number(19)}};
}

// One triangle's frame, in all lanes when F is wide.
template <class F>
STANDOFF_INLINE TriangleFrame<F> frame_of_lane(const float (*numbers)[kLanes], std::uint32_t lane) {
  return frame_from<F>([&](int n) __attribute__((always_inline)) { return F(numbers[n][lane]); });
}

STANDOFF_INLINE TriangleFrame<double> double_frame(const Lattice& lattice, const Brick& brick, const Candidates& c,
                                                   std::uint32_t index) {
  Triple<double> corner[3];
  for (int which = 0; which < 3; ++which) {
    const double* v = c.vertices + 3 * std::size_t{c.triangles[3 * std::size_t{index} + which]};
    corner[which] = {standoff::fma(v[0], lattice.scale, -brick.center[0]),
                     standoff::fma(v[1], lattice.scale, -brick.center[1]),
                     standoff::fma(v[2], lattice.scale, -brick.center[2])};
  }
  return make_frame(corner[0], corner[1], corner[2], double{kLeastLengthSq});
}

// A short triangle against the blocks in its grown box, kCount blocks wide from block x0 on: the count is a constant so
// that the innermost loop has no branch to mispredict.
template <bool kNearest, int kCount>
STANDOFF_INLINE void gather_rows(const Lattice& lattice, const BlockRanges& ranges, const TriangleFrame<WideFloat>& f,
                                 int lane, std::uint32_t index, BrickState& state) {
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
STANDOFF_INLINE void gather_short(const Lattice& lattice, const BlockRanges& ranges, const FrameTable& frames, int lane,
                                  std::uint32_t index, BrickState& state) {
  const int nx = ranges.last[0][lane] - ranges.first[0][lane] + 1,
            ny = ranges.last[1][lane] - ranges.first[1][lane] + 1,
            nz = ranges.last[2][lane] - ranges.first[2][lane] + 1;
  if (nx <= 0 || ny <= 0 || nz <= 0) return;
  const TriangleFrame<WideFloat> f = frame_of_lane<WideFloat>(frames.number, static_cast<std::uint32_t>(lane));
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

STANDOFF_INLINE WidePoint block_samples(const Lattice& lattice, int block) {
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

STANDOFF_INLINE WidePoint sixteen_points(const float (&at)[3][kLanes]) {
  return {WideFloat::load(at[0]), WideFloat::load(at[1]), WideFloat::load(at[2])};
}

// Calls of their own, for all that inline them cost minutes to compile: which of sixteen points are nearer than a
// limit, and where a whole block lies in neither half of the triangle.
__attribute__((noinline)) std::uint32_t points_within(const TriangleLines<WideFloat>& lines, const WidePoint& points,
                                                      float limit_sq) {
  return less(distance_sq(lines, points), WideFloat(limit_sq)).to_bits();
}
__attribute__((noinline)) WideFloat distance_sq_in_both(const TriangleLines<WideFloat>& lines,
                                                        const WidePoint& points) {
  return distance_sq(lines, points);
}

// A long triangle: clumps of blocks, and of those the blocks, are chosen by the exact distance of their centres. Most
// blocks lie in one half of the triangle as a whole, for which half of its lines will do.
template <bool kNearest>
STANDOFF_INLINE void gather_long(const Lattice& lattice, const Brick& brick, const Candidates& c, std::uint32_t index,
                                 BrickState& state) {
  const TriangleLines<WideFloat> lines = make_lines<WideFloat>(double_frame(lattice, brick, c, index));
  const auto within = [&](float radius) __attribute__((always_inline)) {
    const float reach = (lattice.thickness + radius) * (1 + kSlack) + kSlack;
    return reach * reach;
  };
  const float reach_sq = within(lattice.block_radius);
  const WideFloat beside(lattice.block_radius * (1 + kSlack) + kSlack);
  std::uint32_t clumps = points_within(lines, sixteen_points(lattice.clump_centers), within(lattice.clump_radius));
  for (; clumps; clumps &= clumps - 1) {
    const int clump = __builtin_ctz(clumps);
    const WidePoint center = sixteen_points(lattice.block_centers[clump]);
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

template <bool kNearest>
void gather_band(const Lattice& lattice, const Brick& brick, const Candidates& c, BrickState& state) {
  Group group;
  BlockRanges ranges;
  FrameTable frames;
  for (std::int64_t first = 0; first < c.count; first += kLanes) {
    load_group(lattice, brick, c, first, group);
    const WideFloat longest = block_ranges(lattice, group, ranges);
    const std::uint32_t is_long = less(WideFloat(kLongTriangle), longest).to_bits();
    store_frames(make_frame(group.corner[0], group.corner[1], group.corner[2], WideFloat(kLeastLengthSq)),
                 frames.number);
    const int used = c.count - first < kLanes ? static_cast<int>(c.count - first) : kLanes;
    for (int lane = 0; lane < used; ++lane) {
      if (is_long >> lane & 1)
        gather_long<kNearest>(lattice, brick, c, group.index[lane], state);
      else
        gather_short<kNearest>(lattice, ranges, frames, lane, group.index[lane], state);
    }
  }
}

void gather_band_any(const Lattice& lattice, const Brick& brick, const Candidates& c, bool with_nearest,
                     BrickState& state) {
  if (with_nearest)
    gather_band<true>(lattice, brick, c, state);
  else
    gather_band<false>(lattice, brick, c, state);
}

// Samples of the brick inside the grid, per axis.
STANDOFF_INLINE int inside(const Lattice& lattice, const Brick& brick, int axis) {
  const std::int64_t left = lattice.size[axis] - brick.at[axis] * kBrickSide;
  return left < kBrickSide ? static_cast<int>(left) : kBrickSide;
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

unsigned band_tiles(const Lattice& lattice, const Brick& brick, BrickState& state) {
  const WideFloat limit_sq(lattice.thickness_sq);
  const int size[3] = {inside(lattice, brick, 0), inside(lattice, brick, 1), inside(lattice, brick, 2)};
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

// Writes a block's rows of four; those or the parts of them that the grid's far faces cut off are left out.
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

void write_tile(const Lattice& lattice, const BrickState& state, int tile, const TileTarget& target) {
  const WideFloat limit_sq(lattice.thickness_sq), limit(lattice.thickness_world),
      unscale(static_cast<float>(1 / lattice.scale));
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
