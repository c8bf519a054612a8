// SPDX-License-Identifier: Apache-2.0
// How the blocks of a cell choose among its candidates.
//
// Many candidates may be nearest to some point of a cell, but the cell has few samples. A point of any candidate limits
// how far a sample can be from the surface. A block leaves out the candidates whose boxes are farther than this limit
// from each of its samples.
#pragma once

#include "field/cpu/candidate_table.h"
#include "field/cpu/kernels/cell_candidates.inl"
#include "field/cpu/kernels/target.inl"

namespace standoff::cpu::STANDOFF_TARGET {
namespace {

// The samples of a cell: of its blocks, and along the axes.
struct CellSamples {
  WideFloat x, y[kCellBlocks], z[kCellBlocks];
  float plane[3][kCellSide];
};

// Those of the cell whose first sample is `at`, moved by `offset`.
STANDOFF_INLINE CellSamples cell_samples(const BlockLattice& lattice, const int (&at)[3], const float (&offset)[3]) {
  const int bx = at[0] / kBlockX, by = at[1] / kBlockY, bz = at[2] / kBlockZ;
  CellSamples s;
  s.x = WideFloat::load(lattice.x[bx]) + WideFloat(offset[0]);
  for (int n = 0; n < kCellBlocks; ++n) {
    s.y[n] = WideFloat::load(lattice.y[by + n]) + WideFloat(offset[1]);
    s.z[n] = WideFloat::load(lattice.z[bz + n]) + WideFloat(offset[2]);
  }
  for (int n = 0; n < kCellSide; ++n) {
    s.plane[0][n] = lattice.x[bx][n] + offset[0];
    s.plane[1][n] = lattice.y[by + n / kBlockY][n % kBlockY * kBlockX] + offset[1];
    s.plane[2][n] = lattice.z[bz + n / kBlockZ][n % kBlockZ * kBlockX * kBlockY] + offset[2];
  }
  return s;
}

// Squared distances of a cell's samples from the nearest of the points looked at.
struct PointDistances {
  WideFloat least_sq[kBlocksOfCell];

  STANDOFF_INLINE PointDistances() {
    for (WideFloat& l : least_sq) l = WideFloat(__builtin_inff());
  }
  // Takes a point of the surface. Where the surface only passes near it, `added_sq` is added to the squared distances.
  STANDOFF_INLINE void look_at(const CellSamples& s, float px, float py, float pz, float added_sq = 0) {
    const WideFloat dx = s.x - WideFloat(px), dx_sq = fma(dx, dx, WideFloat(added_sq));
    for (int k = 0; k < kCellBlocks; ++k) {
      const WideFloat dz = s.z[k] - WideFloat(pz), dxz_sq = fma(dz, dz, dx_sq);
      for (int j = 0; j < kCellBlocks; ++j) {
        const WideFloat dy = s.y[j] - WideFloat(py);
        least_sq[j + kCellBlocks * k] = min(least_sq[j + kCellBlocks * k], fma(dy, dy, dxz_sq));
      }
    }
  }
};

// The n-th block of the cell whose first sample is `at`.
STANDOFF_INLINE int block_of_cell(const int (&at)[3], int n) {
  return block_index(at[0] / kBlockX, at[1] / kBlockY + n % kCellBlocks, at[2] / kBlockZ + n / kCellBlocks);
}

// The squared distances that boxes must not exceed, sample by sample.
struct BlockLimits {
  alignas(64) float distance_sq[kBlocksOfCell][kLanes];
};

// The points looked at, the boxes and what is computed for their triangles may be off by `slack`.
STANDOFF_INLINE BlockLimits block_limits(const BlockLattice& lattice, const int (&at)[3], const PointDistances& points,
                                         float slack, const BrickState& state) {
  const float slack_sq = slack * slack, within = lattice.thickness * (1 + kSlackRatio);
  const WideFloat added(beyond_slack(slack));
  // A box is out when gap^2 (1-a) - s^2/a > known, and 1/(1-a) < 1 + 2a.
  const WideFloat lowered_by(slack_sq / kSlackShare);
  BlockLimits limits;
  for (int n = 0; n < kBlocksOfCell; ++n) {
    const WideFloat before = min(WideFloat(within * within), WideFloat::load(state.distance_sq[block_of_cell(at, n)]));
    const WideFloat known = min(before, fma(points.least_sq[n], WideFloat(1 + kSlackShare), added));
    ((known + lowered_by) * WideFloat(1 + 2 * kSlackShare)).store(limits.distance_sq[n]);
  }
  return limits;
}

// Calls take(first, chosen) for each sixteen boxes, `first` being the number of the first one; chosen[n] are those that
// the n-th block has to look at. The squared distance of a sample from a box is a sum of three numbers, one per axis,
// and a cell has four different ones on each axis.
template <class Take>
STANDOFF_INLINE void choose_for_blocks(const CellSamples& samples, const BlockLimits& limits,
                                       const float* const (&low)[3], const float* const (&high)[3], int count,
                                       Take take) {
  for (int first = 0; first < count; first += kLanes) {
    WideFloat gap_sq[3][kCellSide];
    for (int axis = 0; axis < 3; ++axis) {
      const WideFloat l = WideFloat::load(low[axis] + first), h = WideFloat::load(high[axis] + first);
      for (int n = 0; n < kCellSide; ++n) {
        const WideFloat at(samples.plane[axis][n]), gap = max(max(l - at, at - h), WideFloat(0));
        gap_sq[axis][n] = gap * gap;
      }
    }
    const int left = count - first;
    const Mask used = mask_from_bits(left < kLanes ? (1u << left) - 1 : 0xffffu);
    Mask chosen[kBlocksOfCell];
    for (int block = 0; block < kBlocksOfCell; ++block) {
      WideFloat beyond(__builtin_inff());  // by how much the farthest limit is missed
      for (int row = 0; row < kBlockY * kBlockZ; ++row) {
        WideFloat in_row(__builtin_inff());
        for (int i = 0; i < kBlockX; ++i)
          in_row = min(in_row, gap_sq[0][i] - WideFloat(limits.distance_sq[block][row * kBlockX + i]));
        beyond = min(beyond, in_row + (gap_sq[1][block % kCellBlocks * kBlockY + row % kBlockY] +
                                       gap_sq[2][block / kCellBlocks * kBlockZ + row / kBlockY]));
      }
      chosen[block] = ~less(WideFloat(0), beyond) & used;
    }
    take(first, chosen);
  }
}

}  // namespace
}  // namespace standoff::cpu::STANDOFF_TARGET
