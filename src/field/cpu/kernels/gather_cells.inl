// SPDX-License-Identifier: Apache-2.0
// The kernels for thick bands and full fields, where a tile has many candidates and each sample needs few of them.
// Cells cull them by distances from the cell's corners. If many are left, each block of the cell culls again, by the
// distances of its samples from boxes (cell_candidates.inl).
#pragma once

#include "field/cpu/kernels.h"
#include "field/cpu/kernels/cell_candidates.inl"
#include "field/cpu/kernels/gather_band.inl"
#include "field/cpu/kernels/triangle_frames.inl"
#include "geometry/triangle_frame.h"

namespace standoff::cpu::STANDOFF_TARGET {
namespace {

// Lists the cell's candidates one by one, so that the loop over them has no branch to mispredict.
STANDOFF_INLINE void list_chosen(CandidateTable& table) {
  table.list.count = 0;
  for (int n = 0; n < table.active_groups; ++n) {
    const CandidateTable::Active& active = table.active[n];
    const Mask lanes = mask_from_bits(active.lanes);
    const WideUint first(static_cast<std::uint32_t>(active.group) * kLanes);
    table.list.count += store_packed(table.list.candidate + table.list.count, lanes, first + lane_numbers());
  }
}

// Lists their extents in the same order.
STANDOFF_INLINE void list_extents(CandidateTable& table) {
  int count = 0;
  for (int n = 0; n < table.active_groups; ++n) {
    const CandidateTable::Active& active = table.active[n];
    const Mask lanes = mask_from_bits(active.lanes);
    const auto& from = table.groups[active.group].extent;
    auto& to = table.listed_extent;
    for (int axis = 0; axis < 3; ++axis) {
      store_packed(to.low[axis] + count, lanes, WideFloat::load(from.low[axis]));
      store_packed(to.high[axis] + count, lanes, WideFloat::load(from.high[axis]));
      store_packed(to.point[axis] + count, lanes, WideFloat::load(from.point[axis]));
    }
    count += __builtin_popcount(active.lanes);
  }
}

// Lists the candidates of each block of the cell.
STANDOFF_INLINE void list_for_blocks(const BlockLattice& lattice, CandidateTable& table, const CellCorners& cell,
                                     const int (&at)[3], const BrickState& state) {
  list_extents(table);
  const CellSamples samples = cell_samples(lattice, at, {0, 0, 0});
  const auto& extent = table.listed_extent;
  PointDistances distances;
  for (int n = 0; n < table.list.count; ++n)
    distances.look_at(samples, extent.point[0][n], extent.point[1][n], extent.point[2][n]);
  // The error of a long triangle's lines does not grow with its length, but may grow with its distance.
  WideFloat widest(0);
  std::uint32_t any_long = 0;
  for (int n = 0; n < table.active_groups; ++n) {
    const CandidateTable::Group& g = table.groups[table.active[n].group];
    widest = max(widest, select(mask_from_bits(g.is_long), WideFloat(0), WideFloat::load(g.slack)));
    any_long |= g.is_long;
  }
  for (const CandidateTable::Corner* reference : cell.reference)
    distances.look_at(samples, reference->point[0], reference->point[1], reference->point[2], reference->added_sq);
  // A point's own rounding is below a quarter of its triangle's slack.
  const float slack = 2.25f * reduce_max(widest);
  const BlockLimits limits = any_long != 0
                                 ? block_limits(lattice, at, distances, slack + 2 * kSlack, kSlackShare, state)
                                 : block_limits(lattice, at, distances, slack, kSquareRounding, state);
  for (CandidateList& list : table.block_list) list.count = 0;
  choose_for_blocks(
      samples, limits, {extent.low[0], extent.low[1], extent.low[2]}, {extent.high[0], extent.high[1], extent.high[2]},
      table.list.count, [&](int first, const Mask(&chosen)[kBlocksOfCell]) __attribute__((always_inline)) {
        const WideUint candidates = WideUint::load(table.list.candidate + first);
        for (int n = 0; n < kBlocksOfCell; ++n) {
          CandidateList& list = table.block_list[n];
          list.count += store_packed(list.candidate + list.count, chosen[n], candidates);
        }
      });
}

template <bool kNearest>
STANDOFF_INLINE void lower(WideFloat& best, WideUint& nearest, const WideFloat& d, std::uint32_t index) {
  if constexpr (kNearest) {
    const WideUint mine(index);
    nearest = select(less(d, best) | (equal(d, best) & less(mine, nearest)), mine, nearest);
  }
  best = min(d, best);
}

// The lines of a long triangle, which are set up in double: a tile's candidate keeps them for its other lists.
template <class Group>
STANDOFF_INLINE TriangleLines<WideFloat> lines_of(const BlockLattice& lattice, const Brick& brick, const Candidates& c,
                                                  Group& g, std::uint32_t lane) {
  if constexpr (requires { g.lines; }) {
    if (!(g.has_lines >> lane & 1)) {
      g.lines[lane] = make_lines<float>(double_frame(lattice, brick, c, g.index[lane]));
      g.has_lines |= 1u << lane;
    }
    return in_all_lanes(g.lines[lane]);
  } else {
    return make_lines<WideFloat>(double_frame(lattice, brick, c, g.index[lane]));
  }
}

// Measures the listed candidates from the blocks (bx, by + j, bz + k), j and k below kSide.
template <bool kNearest, int kSide, class Group>
STANDOFF_INLINE void gather_listed(const BlockLattice& lattice, const Brick& brick, const Candidates& c, Group* groups,
                                   const CandidateList& list, int bx, int by, int bz, BrickState& state) {
  constexpr int kCount = kSide * kSide;
  const auto block = [&](int n) __attribute__((always_inline)) {
    return block_index(bx, by + n % kSide, bz + n / kSide);
  };
  const WideFloat x = WideFloat::load(lattice.x[bx]);
  WideFloat y[kSide], z[kSide], best[kCount];
  WideUint nearest[kCount];
  for (int n = 0; n < kSide; ++n) {
    y[n] = WideFloat::load(lattice.y[by + n]);
    z[n] = WideFloat::load(lattice.z[bz + n]);
  }
  for (int n = 0; n < kCount; ++n) {
    best[n] = WideFloat::load(state.distance_sq[block(n)]);
    if constexpr (kNearest) nearest[n] = WideUint::load(state.nearest[block(n)]);
  }
  for (int m = 0; m < list.count; ++m) {
    Group& g = groups[list.candidate[m] / kLanes];
    const std::uint32_t lane = list.candidate[m] % kLanes;
    if (g.is_long >> lane & 1) {
      const TriangleLines<WideFloat> lines = lines_of(lattice, brick, c, g, lane);
      for (int n = 0; n < kCount; ++n)
        lower<kNearest>(best[n], nearest[n], distance_sq(lines, {x, y[n % kSide], z[n / kSide]}), g.index[lane]);
      continue;
    }
    const TriangleFrame<WideFloat> f = frame_of_lane<WideFloat>(g.frame, lane);
    for (int k = 0; k < kSide; ++k) {
      const WideFloat qz = fma(z[k], f.q.g.z, f.q.c), yz = fma(z[k], f.y.g.z, f.y.c), zz = fma(z[k], f.z.g.z, f.z.c);
      for (int j = 0; j < kSide; ++j) {
        const WideFloat d =
            frame_distance_sq(f, fma(x, f.q.g.x, fma(y[j], f.q.g.y, qz)), fma(x, f.y.g.x, fma(y[j], f.y.g.y, yz)),
                              fma(x, f.z.g.x, fma(y[j], f.z.g.y, zz)));
        lower<kNearest>(best[j + kSide * k], nearest[j + kSide * k], d, g.index[lane]);
      }
    }
  }
  for (int n = 0; n < kCount; ++n) {
    best[n].store(state.distance_sq[block(n)]);
    if constexpr (kNearest) nearest[n].store(state.nearest[block(n)]);
  }
  state.samples_examined += std::int64_t{kLanes} * kCount * list.count;
}

// With more candidates than this, each block of a cell culls them once more. It decides time only.
constexpr int kManyCandidates = 40;

// Gathers one cell from the candidates of its tile.
template <bool kNearest>
STANDOFF_INLINE void gather_cell(const BlockLattice& lattice, const Brick& brick, const Candidates& c,
                                 CandidateTable& table, const CellCorners& cell, const int (&at)[3],
                                 BrickState& state) {
  const int bx = at[0] / kBlockX, by = at[1] / kBlockY, bz = at[2] / kBlockZ;
  choose(table, cell);
  list_chosen(table);
  if (table.list.count <= kManyCandidates)
    return gather_listed<kNearest, kCellBlocks>(lattice, brick, c, table.groups, table.list, bx, by, bz, state);
  list_for_blocks(lattice, table, cell, at, state);
  for (int n = 0; n < kBlocksOfCell; ++n)
    gather_listed<kNearest, 1>(lattice, brick, c, table.groups, table.block_list[n], bx, by + n % kCellBlocks,
                               bz + n / kCellBlocks, state);
}

template <bool kNearest>
void gather_tile(const BlockLattice& lattice, const Brick& brick, int tile, const Candidates& c, CandidateTable& table,
                 BrickState& state) {
  constexpr int tile_side = DistanceField::kTileSide;
  const int corner[3] = {(tile & 1) * tile_side, (tile >> 1 & 1) * tile_side, (tile >> 2) * tile_side};
  place_corners(lattice, corner, table);
  for (std::int64_t first = 0; first < c.count; first += std::int64_t{CandidateTable::kGroups} * kLanes) {
    fill_table(lattice, brick, c, first, table);
    look_from_corners(table);
    for (int n = 0; n < kTileCells * kTileCells * kTileCells; ++n) {
      const int cell[3] = {n & 1, n >> 1 & 1, n >> 2};
      const int at[3] = {corner[0] + cell[0] * kCellSide, corner[1] + cell[1] * kCellSide,
                         corner[2] + cell[2] * kCellSide};
      if (at[0] >= inside<kBrickSide>(lattice, brick.at, 0) || at[1] >= inside<kBrickSide>(lattice, brick.at, 1) ||
          at[2] >= inside<kBrickSide>(lattice, brick.at, 2))
        continue;
      gather_cell<kNearest>(lattice, brick, c, table, cell_corners(lattice, table, cell), at, state);
    }
  }
}

// The kernel for crowded cells, whose very many candidates are small compared with the spacing: first their boxes are
// tested, then only the triangles that some block keeps (cell_candidates.inl) are set up and measured.

// The error of the candidates' points and distances, beside the share of themselves that block_limits() adds. Points
// are rounded to kBoxError of the grid, or to a share of their distance if they lie far outside. The error of distances
// in a frame is kFrameError of its farthest corner's distance from the brick's centre. Up to kNear this is less than
// kSlack. Beyond, a triangle that is not long is at least half as far from each sample, and the share covers the error.
// Long triangles are measured by lines, whose error does not grow with their length.
STANDOFF_INLINE float slack_in(const CrowdedCell& cell) {
  constexpr float kNear = 64;  // grid units
  static_assert(kNear * kFrameError + kFrameSlack < kSlack && kNear >= 2 * (kLongTriangle + kBrickSide));
  static_assert(2 * 2 * kFrameError < kSlackShare);
  return cell.extent * kBoxError + kSlack;
}

// The limits of the cell's samples after they looked at a point of some entries, each in the triangle `places[n]`.
STANDOFF_INLINE BlockLimits crowded_limits(const BlockLattice& lattice, const CrowdedCell& cell,
                                           const CellSamples& samples, const std::uint32_t* places, std::int64_t count,
                                           CrowdedTable& table, const BrickState& state) {
  PointDistances distances;
  for (int n = 0; n < kBlocksOfCell; ++n) distances.least_sq[n] = WideFloat::load(table.least_sq[n]);
  for (std::int64_t n = 0; n < count; ++n) {
    const float* const point = cell.points[places[n]];
    distances.look_at(samples, point[0], point[1], point[2]);
  }
  for (int n = 0; n < kBlocksOfCell; ++n) distances.least_sq[n].store(table.least_sq[n]);
  return block_limits(lattice, cell.at, distances, 2 * slack_in(cell), kSlackShare, state);
}

void keep_near(const BlockLattice& lattice, const CrowdedCell& cell, const std::uint32_t* in_entry, CrowdedTable& table,
               const BrickState& state, BoxArrays& kept) {
  const CellSamples samples = cell_samples(lattice, cell.at, cell.brick_center);
  const BoxArrays& b = cell.boxes;
  const BlockLimits limits = crowded_limits(lattice, cell, samples, in_entry, b.count, table, state);
  std::int64_t count = 0;
  choose_for_blocks(
      samples, limits, {b.low[0], b.low[1], b.low[2]}, {b.high[0], b.high[1], b.high[2]},
      static_cast<int>(b.count), [&](int first, const Mask(&chosen)[kBlocksOfCell]) __attribute__((always_inline)) {
        const Mask any = (chosen[0] | chosen[1]) | (chosen[2] | chosen[3]);
        for (int axis = 0; axis < 3; ++axis) {
          store_packed(kept.low[axis] + count, any, WideFloat::load(b.low[axis] + first));
          store_packed(kept.high[axis] + count, any, WideFloat::load(b.high[axis] + first));
        }
        count += store_packed(kept.entry + count, any, WideUint::load(b.entry + first));
      });
  kept.count = count;
}

// Lists the candidates of each block, numbered in the order of all that some block keeps.
STANDOFF_INLINE void choose_crowded(const CrowdedCell& cell, const CellSamples& samples, const BlockLimits& limits,
                                    std::int64_t first, int count, CrowdedTable& table) {
  table.chosen_count = 0;
  for (CandidateList& list : table.block_list) list.count = 0;
  alignas(64) std::uint32_t number[kLanes] = {};
  const auto side = [&](float* const* sides, int axis) { return sides[axis] + first; };
  const BoxArrays& b = cell.boxes;
  choose_for_blocks(
      samples, limits, {side(b.low, 0), side(b.low, 1), side(b.low, 2)},
      {side(b.high, 0), side(b.high, 1), side(b.high, 2)},
      count, [&](int at, const Mask(&chosen)[kBlocksOfCell]) __attribute__((always_inline)) {
        std::uint32_t any = 0;
        for (const Mask& mask : chosen) any |= mask.to_bits();
        if (any == 0) return;
        for (; any != 0; any &= any - 1) {
          const int lane = __builtin_ctz(any);
          number[lane] = static_cast<std::uint32_t>(table.chosen_count);
          table.chosen[table.chosen_count++] = cell.index[b.entry[first + at + lane]];
        }
        const WideUint numbers = WideUint::load(number);
        for (int n = 0; n < kBlocksOfCell; ++n) {
          CandidateList& list = table.block_list[n];
          list.count += store_packed(list.candidate + list.count, chosen[n], numbers);
        }
      });
}

STANDOFF_INLINE void set_up_chosen(const BlockLattice& lattice, const Brick& brick, const Candidates& mesh,
                                   CrowdedTable& table) {
  const Candidates chosen{mesh.mesh, table.chosen, table.chosen_count};
  for (int first = 0; first < table.chosen_count; first += kLanes) {
    Group loaded;
    load_group(lattice, brick, chosen, first, loaded);
    shrink_specks(lattice, loaded);
    set_up(loaded, table.groups[first / kLanes]);
  }
}

template <bool kNearest>
void gather_crowded(const BlockLattice& lattice, const Brick& brick, const CrowdedCell& cell, const Candidates& mesh,
                    CrowdedTable& table, BrickState& state) {
  const CellSamples samples = cell_samples(lattice, cell.at, cell.brick_center);
  for (std::int64_t first = 0; first < cell.boxes.count; first += CrowdedTable::kMost) {
    const std::int64_t left = cell.boxes.count - first;
    const int count = left < CrowdedTable::kMost ? static_cast<int>(left) : CrowdedTable::kMost;
    const BlockLimits limits = crowded_limits(lattice, cell, samples, cell.boxes.entry + first, count, table, state);
    choose_crowded(cell, samples, limits, first, count, table);
    set_up_chosen(lattice, brick, mesh, table);
    for (int n = 0; n < kBlocksOfCell; ++n)
      gather_listed<kNearest, 1>(lattice, brick, mesh, table.groups, table.block_list[n], cell.at[0] / kBlockX,
                                 cell.at[1] / kBlockY + n % kCellBlocks, cell.at[2] / kBlockZ + n / kCellBlocks, state);
  }
}

}  // namespace
}  // namespace standoff::cpu::STANDOFF_TARGET
