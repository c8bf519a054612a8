// SPDX-License-Identifier: Apache-2.0
// The kernels for meshes far smaller than their distance, whose triangles are specks (lattice.h): points. A brick culls
// them by each other, then each tile, and measures those that are left.
//
// A point p is culled by a point q if q is nearer to all samples x of a box, by more than rounding may hide. With
// v = p - q and y = x - q, |x-p|^2 - |x-q|^2 = v.v - 2 y.v. Over a box with the centre c and the half extents h its
// least value is v.v - 2 (c-q).v - 2 sum h_a |v_a|. The points are as close together as the mesh is small: v is exact,
// or nearly so, and all terms are small. Squares of p and q, which are large, would lose what tells them apart.
#pragma once

#include "field/cpu/kernels/gather_band.inl"
#include "field/cpu/kernels/triangle_frames.inl"

namespace standoff::cpu::STANDOFF_TARGET {
namespace {

// Drops points that are in the place of an earlier one, nearly all of these.
STANDOFF_INLINE void drop_copies(SpeckTable& table) {
  SpeckTable::Points& p = table.brick;
  static_assert(SpeckTable::kMost == 1 << 12);
  for (std::uint16_t& place : table.places) place = 0;
  int kept = 0;
  for (int n = 0; n < p.count; ++n) {
    std::uint32_t bits[3];
    for (int axis = 0; axis < 3; ++axis) __builtin_memcpy(&bits[axis], &p.at[axis][n], sizeof bits[axis]);
    std::uint16_t& place = table.places[(bits[0] * 0x9e3779b1u + bits[1] * 0x85ebca77u + bits[2] * 0xc2b2ae3du) >> 20];
    const int before = place - 1;
    if (before >= 0 && p.at[0][before] == p.at[0][n] && p.at[1][before] == p.at[1][n] &&
        p.at[2][before] == p.at[2][n]) {
      if (p.index[n] < p.index[before]) p.index[before] = p.index[n];
      continue;
    }
    for (int axis = 0; axis < 3; ++axis) p.at[axis][kept] = p.at[axis][n];
    p.index[kept] = p.index[n];
    place = static_cast<std::uint16_t>(++kept);
  }
  p.count = kept;
}

void load_specks(const BlockLattice& lattice, const Brick& brick, const Candidates& c, SpeckTable& table) {
  SpeckTable::Points& p = table.brick;
  p.count = table.others_count = 0;
  for (std::int64_t first = 0; first < c.count; first += kLanes) {
    Group group;
    load_group(lattice, brick, c, first, group);
    const std::int64_t left = c.count - first;
    const Mask used = mask_from_bits(left < kLanes ? (1u << left) - 1 : 0xffffu);
    const Mask specks = shrink_specks(lattice, group) & used;
    const WideUint index = WideUint::load(group.index);
    for (int axis = 0; axis < 3; ++axis) store_packed(p.at[axis] + p.count, specks, component(group.corner[0], axis));
    p.count += store_packed(p.index + p.count, specks, index);
    table.others_count += store_packed(table.others + table.others_count, used & ~specks, index);
  }
  drop_copies(table);
}

// A box around samples.
struct SampleBox {
  float center[3], half[3];
};

// `count` samples of a brick on each axis, from `first` on.
STANDOFF_INLINE SampleBox box_of_samples(const BlockLattice& lattice, const int (&first)[3], int count) {
  SampleBox box;
  for (int axis = 0; axis < 3; ++axis) {
    const float low = lattice.coordinate[axis][first[axis]], high = lattice.coordinate[axis][first[axis] + count - 1];
    box.center[axis] = (low + high) / 2;
    box.half[axis] = (high - low) / 2 * (1 + kSquareRounding);
  }
  return box;
}

// Finds points nearer to the corners of the box than those known so far.
STANDOFF_INLINE void find_nearest(const SpeckTable::Points& p, const SampleBox& box, SpeckTable::Nearest& nearest) {
  for (int corner = 0; corner < 8; ++corner) {
    WideFloat at[3], best(__builtin_inff());
    for (int axis = 0; axis < 3; ++axis)
      at[axis] = WideFloat(box.center[axis] + (corner >> axis & 1 ? box.half[axis] : -box.half[axis]));
    WideUint number = lane_numbers(), which = number;
    for (int n = 0; n < p.count; n += kLanes, number = number + WideUint(kLanes)) {
      const WideFloat x = WideFloat::load(p.at[0] + n) - at[0], y = WideFloat::load(p.at[1] + n) - at[1],
                      z = WideFloat::load(p.at[2] + n) - at[2];
      const WideFloat sq = fma(x, x, fma(y, y, z * z));
      const Mask nearer = less(sq, best) & less(number, WideUint(static_cast<std::uint32_t>(p.count)));
      best = select(nearer, sq, best);
      which = select(nearer, number, which);
    }
    const float least = reduce_min(best);
    if (!(least < nearest.distance_sq[corner])) continue;
    alignas(64) std::uint32_t numbers[kLanes];
    which.store(numbers);
    const std::uint32_t n = numbers[__builtin_ctz(equal(best, WideFloat(least)).to_bits())];
    nearest.distance_sq[corner] = least;
    for (int axis = 0; axis < 3; ++axis) nearest.at[corner][axis] = p.at[axis][n];
  }
}

// A point q in the form of the test.
struct SpeckReference {
  float at[3];
  float twice_to_center[3];  // 2 (c - q)
  float twice_half[3];       // 2 h, raised by the rounding of the sum
  float margin;              // by how much squares must differ, so that rounding cannot make p the nearer one
};

// Rounding in the sum, as a share of each of its terms: eight operations.
constexpr float kSumRounding = 1e-6f;
static_assert(kSumRounding > 1.5f * gamma_float(8));

STANDOFF_INLINE SpeckReference reference_of(const float (&at)[3], const SampleBox& box) {
  SpeckReference r;
  float farthest_sq = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const float to_center = box.center[axis] - at[axis], far = __builtin_fabsf(to_center) + box.half[axis];
    r.at[axis] = at[axis];
    r.twice_to_center[axis] = 2 * to_center;
    r.twice_half[axis] = 2 * (box.half[axis] + kSumRounding * far);
    farthest_sq += far * far;
  }
  r.margin = 2.01f * kSpeckRounding * farthest_sq;
  return r;
}

// Copies to `kept`, which may be the same memory, the points that may be nearest to a sample in the box.
STANDOFF_INLINE void keep_specks(const SpeckTable::Points& p, const SampleBox& box, const SpeckTable::Nearest& nearest,
                                 SpeckTable::Points& kept) {
  SpeckReference references[8];
  int count = 0;
  for (int n = 0; n < 8; ++n)
    if (nearest.distance_sq[n] < __builtin_inff()) references[count++] = reference_of(nearest.at[n], box);
  int left = 0;
  for (int first = 0; first < p.count; first += kLanes) {
    const WideFloat at[3] = {WideFloat::load(p.at[0] + first), WideFloat::load(p.at[1] + first),
                             WideFloat::load(p.at[2] + first)};
    const WideUint index = WideUint::load(p.index + first);
    Mask may = mask_from_bits(p.count - first < kLanes ? (1u << (p.count - first)) - 1 : 0xffffu);
    for (int n = 0; n < count && may.to_bits() != 0; ++n) {
      const SpeckReference& r = references[n];
      WideFloat least(-r.margin);
      for (int axis = 0; axis < 3; ++axis) {
        const WideFloat v = at[axis] - WideFloat(r.at[axis]), size = abs(v);
        least = fma(v, v - WideFloat(r.twice_to_center[axis]), least);
        least = least - size * fma(WideFloat(kSumRounding), size, WideFloat(r.twice_half[axis]));
      }
      may = may & ~less(WideFloat(0), least);
    }
    for (int axis = 0; axis < 3; ++axis) store_packed(kept.at[axis] + left, may, at[axis]);
    left += store_packed(kept.index + left, may, index);
  }
  kept.count = left;
}

// Measures the points from a tile's samples. A frame of a triangle without extent would give the same bits.
template <bool kNearest>
STANDOFF_INLINE void measure_specks(const BlockLattice& lattice, const SpeckTable::Points& p, int tile,
                                    BrickState& state) {
  constexpr int nx = kBlocksX / 2, ny = kBlocksY / 2, nz = kBlocksZ / 2;
  const int x0 = (tile & 1) * nx, y0 = (tile >> 1 & 1) * ny, z0 = (tile >> 2 & 1) * nz;
  for (int bz = z0; bz < z0 + nz; ++bz)
    for (int by = y0; by < y0 + ny; ++by) {
      const WideFloat y = WideFloat::load(lattice.y[by]), z = WideFloat::load(lattice.z[bz]);
      for (int bx = x0; bx < x0 + nx; ++bx) {
        const int block = block_index(bx, by, bz);
        const WideFloat x = WideFloat::load(lattice.x[bx]);
        WideFloat best = WideFloat::load(state.distance_sq[block]);
        WideUint nearest(kNoTriangle);
        if constexpr (kNearest) nearest = WideUint::load(state.nearest[block]);
        for (int n = 0; n < p.count; ++n) {
          const WideFloat dx = x - WideFloat(p.at[0][n]), dy = y - WideFloat(p.at[1][n]),
                          dz = z - WideFloat(p.at[2][n]);
          const WideFloat d = fma(dz, dz, fma(dx, dx, dy * dy));
          if constexpr (kNearest) {
            const WideUint mine(p.index[n]);
            nearest = select(less(d, best) | (equal(d, best) & less(mine, nearest)), mine, nearest);
          }
          best = min(d, best);
        }
        best.store(state.distance_sq[block]);
        if constexpr (kNearest) nearest.store(state.nearest[block]);
      }
    }
  state.samples_examined += std::int64_t{kLanes} * nx * ny * nz * p.count;
}

template <bool kNearest>
void gather_specks(const BlockLattice& lattice, unsigned tiles, SpeckTable& table, BrickState& state) {
  const SampleBox brick = box_of_samples(lattice, {0, 0, 0}, kBrickSide);
  find_nearest(table.brick, brick, table.nearest);
  keep_specks(table.brick, brick, table.nearest, table.brick);
  constexpr int kSide = DistanceField::kTileSide;
  for (; tiles != 0 && table.brick.count != 0; tiles &= tiles - 1) {
    const int tile = __builtin_ctz(tiles);
    const SampleBox box =
        box_of_samples(lattice, {(tile & 1) * kSide, (tile >> 1 & 1) * kSide, (tile >> 2) * kSide}, kSide);
    SpeckTable::Nearest nearest;
    nearest.forget();
    find_nearest(table.brick, box, nearest);
    keep_specks(table.brick, box, nearest, table.tile);
    // Tables before this one may have had nearer specks.
    keep_specks(table.tile, box, table.nearest, table.tile);
    measure_specks<kNearest>(lattice, table.tile, tile, state);
  }
}

}  // namespace
}  // namespace standoff::cpu::STANDOFF_TARGET
