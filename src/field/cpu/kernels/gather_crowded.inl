// SPDX-License-Identifier: Apache-2.0
// The kernel for cells of tiles with very many candidates, which are small against the spacing: their boxes are tested
// before anything is known of the triangles, and only those that some block of the cell chooses (block_candidates.inl)
// are set up and measured.
#pragma once

#include "field/cpu/crowded_cell.h"
#include "field/cpu/kernels/gather_cells.inl"

namespace standoff::cpu::STANDOFF_TARGET {
namespace {

// What the points of candidates, and the distances computed for them, may be off by beside the share of themselves that
// block_limits() adds. Points are rounded to kBoxError of the grid, or, where they lie far outside, to a share of their
// distance. Distances in a frame may be off by kFrameError of how far the triangle reaches from the brick's centre. Up
// to kNear that is less than kSlack; beyond, a triangle that is not long is half as far from each sample, and the share
// covers it. Long triangles are measured by lines, which do not lose more the longer they are.
STANDOFF_INLINE float slack_in(const CrowdedCell& cell) {
  constexpr float kNear = 64;  // grid units
  static_assert(kNear * kFrameError < kSlack && kNear >= 2 * (kLongTriangle + kBrickSide));
  static_assert(2 * kFrameError < kSlackShare / 2);
  return cell.extent * kBoxError + kSlack;
}

// Lists for each block the candidates it chooses, numbered in the order of all that are chosen.
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
    PointDistances distances;
    for (int n = 0; n < count; ++n) {
      const float* const point = cell.points[cell.boxes.entry[first + n]];
      distances.look_at(samples, point[0], point[1], point[2]);
    }
    const BlockLimits limits = block_limits(lattice, cell.at, distances, slack_in(cell), state);
    choose_crowded(cell, samples, limits, first, count, table);
    set_up_chosen(lattice, brick, mesh, table);
    for (int n = 0; n < kBlocksOfCell; ++n)
      gather_listed<kNearest, 1>(lattice, brick, mesh, table.groups, table.block_list[n], cell.at[0] / kBlockX,
                                 cell.at[1] / kBlockY + n % kCellBlocks, cell.at[2] / kBlockZ + n / kCellBlocks, state);
  }
}

void gather_crowded_any(const BlockLattice& lattice, const Brick& brick, const CrowdedCell& cell,
                        const Candidates& mesh, bool with_nearest, CrowdedTable& table, BrickState& state) {
  if (with_nearest)
    gather_crowded<true>(lattice, brick, cell, mesh, table, state);
  else
    gather_crowded<false>(lattice, brick, cell, mesh, table, state);
}

}  // namespace
}  // namespace standoff::cpu::STANDOFF_TARGET
