// SPDX-License-Identifier: Apache-2.0
// How the cells of a tile cull its candidates.
//
// The candidates of a tile are set up once, in groups of sixteen, and measured from the corners of its 2x2x2 cells. The
// nearest point found from a corner is a reference q for the cells around it.
//
// A candidate beats q at a sample x of the cell if it holds a point p with |x-p|^2 < |x-q|^2. The difference of both
// sides is linear in x, so if p beats q anywhere in the cell, it beats q at a corner. So a candidate is culled if some
// q is at most as far as the candidate from every corner. The test for boxes (cull_boxes.inl) keeps tilted triangles,
// whose boxes are much larger than they are; this one does not.
#pragma once

#include "field/cpu/kernels.h"
#include "field/cpu/kernels/triangle_frames.inl"

namespace standoff::cpu::STANDOFF_TARGET {
namespace {

// Squares of distances are compared, so margins of distances become margins of squares. With M the error of what is
// compared and d the distance between a sample and the reference, (d+M)^2 = d^2 + M (2d+M).

// No two samples of a tile are farther apart, grid units.
constexpr float kTileDiagonal = 25;
static_assert(kTileDiagonal * kTileDiagonal > 3 * 4 * (DistanceField::kTileSide - 1) * (DistanceField::kTileSide - 1));

// A coordinate far from all samples, in grid units, whose square is finite.
constexpr float kFarAway = 0x1p60f;

STANDOFF_INLINE void set_up(const Group& loaded, FrameGroup& g) {
  g.is_long = long_lanes(loaded);
  store_frames(make_frames(loaded), g.frame);
  WideUint::load(loaded.index).store(g.index);
}

// Sets up the candidates first, first + 1, ... while there is room.
STANDOFF_INLINE void fill_table(const BlockLattice& lattice, const Brick& brick, const Candidates& c,
                                std::int64_t first, CandidateTable& table) {
  table.count = 0;
  for (; table.count < CandidateTable::kGroups && first < c.count; ++table.count, first += kLanes) {
    CandidateTable::Group& g = table.groups[table.count];
    Group loaded;
    load_group(lattice, brick, c, first, loaded);
    shrink_specks(lattice, loaded);
    set_up(loaded, g);
    const Mask is_long = mask_from_bits(g.is_long);
    WideFloat farthest_sq(0);
    for (int axis = 0; axis < 3; ++axis) {
      const WideFloat a = component(loaded.corner[0], axis), b = component(loaded.corner[1], axis),
                      d = component(loaded.corner[2], axis);
      const WideFloat low = min(a, min(b, d)), high = max(a, max(b, d));
      const WideFloat far = max(abs(low), abs(high));
      farthest_sq = fma(far, far, farthest_sq);
      low.store(g.extent.low[axis]);
      high.store(g.extent.high[axis]);
      // Rounding may move the centroid of a long triangle far off it: put its point where it bounds nothing.
      select(is_long, WideFloat(kFarAway), (a + b + d) * WideFloat(1 / 3.0f)).store(g.extent.point[axis]);
    }
    const WideFloat error = select(is_long, WideFloat(kLongFrameError), WideFloat(kFrameError));
    const WideFloat slack = fma(sqrt(farthest_sq), error, WideFloat(kFrameSlack));
    slack.store(g.slack);
    const std::int64_t left = c.count - first;
    g.lanes = left < kLanes ? (1u << left) - 1 : 0xffffu;
    g.has_lines = 0;
  }
}

constexpr int kTileCells = DistanceField::kTileSide / kCellSide;
static_assert(CandidateTable::kCornersPerAxis == kTileCells + 1);

// A coordinate of the tile's lattice of cells relative to the brick's centre: its faces lie on the outermost samples.
STANDOFF_INLINE float corner_coordinate(const BlockLattice& lattice, int axis, int first_sample, int n) {
  const float sample = n == 0            ? 0
                       : n == kTileCells ? DistanceField::kTileSide - 1
                                         : kCellSide * static_cast<float>(n) - 0.5f;
  const float middle = (kBrickSide - 1) / 2.0f;
  return (static_cast<float>(first_sample) + sample - middle) *
         static_cast<float>(lattice.spacing[axis] * lattice.scale);
}

// Places the corners of a tile's cells; no point of the surface is known yet.
STANDOFF_INLINE void place_corners(const BlockLattice& lattice, const int (&first_sample)[3], CandidateTable& table) {
  constexpr int kSide = CandidateTable::kCornersPerAxis;
  for (int n = 0; n < CandidateTable::kCorners; ++n) {
    CandidateTable::Corner& corner = table.corners[n];
    const int number[3] = {n % kSide, n / kSide % kSide, n / (kSide * kSide)};
    for (int axis = 0; axis < 3; ++axis)
      corner.at[axis] = corner_coordinate(lattice, axis, first_sample[axis], number[axis]);
    corner.point[0] = corner.point[1] = corner.point[2] = corner.added_sq = 0;
    corner.distance_sq = __builtin_inff();
  }
}

// The nearest candidate to a corner so far, lane by lane.
struct NearestOfLanes {
  alignas(64) float distance_sq[kLanes];
  alignas(64) std::uint32_t group[kLanes];
};

// Stores the point of the surface nearest to a corner.
STANDOFF_INLINE void take_nearest(const CandidateTable& table, const NearestOfLanes& found,
                                  CandidateTable::Corner& corner) {
  const WideFloat distances = WideFloat::load(found.distance_sq);
  const float best = reduce_min(distances);
  if (!(best < corner.distance_sq)) return;
  const int lane = __builtin_ctz(equal(distances, WideFloat(best)).to_bits());
  const CandidateTable::Group& g = table.groups[found.group[lane]];
  const Triple<float> q = closest_in_frame(frame_of_lane<float>(g.frame, static_cast<std::uint32_t>(lane)),
                                           Triple<float>{corner.at[0], corner.at[1], corner.at[2]});
  corner.point[0] = q.x;
  corner.point[1] = q.y;
  corner.point[2] = q.z;
  corner.distance_sq = best;
  // The point is within the slack of the surface, and the distance that a sample gets of its triangle is as much off.
  const float error = 2 * g.slack[lane];
  corner.added_sq = error * (2 * (standoff::sqrt(best) + kTileDiagonal) + error);
}

// Measures all candidates of the table from all corners, and finds the point of the surface nearest to each.
//
// A candidate's distances are lowered by s, what they and those that samples get of it may be off by: twice its slack.
// (d-s)^2 >= d^2 (1-a) - s^2/a for any a in (0, 1), and a = s/r makes the second term s r. For r twice as long as any
// distance from the tile that may matter, this is also what the samples' error takes.
STANDOFF_INLINE void look_from_corners(CandidateTable& table) {
  constexpr int kSide = CandidateTable::kCornersPerAxis;
  NearestOfLanes found[CandidateTable::kCorners];
  for (NearestOfLanes& near_corner : found) WideFloat(__builtin_inff()).store(near_corner.distance_sq);
  const auto coordinate = [&](int n, int axis) __attribute__((always_inline)) {
    return WideFloat(table.corners[n].at[axis]);
  };
  for (int n = 0; n < table.count; ++n) {
    CandidateTable::Group& g = table.groups[n];
    const WideUint number(static_cast<std::uint32_t>(n));
    const TriangleFrame<WideFloat> f = load_frames(g.frame);
    const WideFloat error = WideFloat(2) * WideFloat::load(g.slack);
    const float(&middle)[3] = table.corners[CandidateTable::kCorners / 2].at;
    const WideFloat from_middle =
        sqrt(distance_sq(f, {WideFloat(middle[0]), WideFloat(middle[1]), WideFloat(middle[2])}));
    const WideFloat range = fma(WideFloat(2), from_middle + error, WideFloat(2 * kTileDiagonal));
    const WideFloat kept = WideFloat(1) - error / range, less_error = -(error * range);
    for (int k = 0, corner = 0; k < kSide; ++k) {
      const WideFloat z = coordinate(corner, 2);
      const WideFloat qz = fma(z, f.q.g.z, f.q.c), yz = fma(z, f.y.g.z, f.y.c), zz = fma(z, f.z.g.z, f.z.c);
      for (int j = 0; j < kSide; ++j) {
        const WideFloat y = coordinate(corner, 1);
        const WideFloat qy = fma(y, f.q.g.y, qz), yy = fma(y, f.y.g.y, yz), zy = fma(y, f.z.g.y, zz);
        for (int i = 0; i < kSide; ++i, ++corner) {
          const WideFloat x = coordinate(corner, 0);
          const WideFloat d = frame_distance_sq(f, fma(x, f.q.g.x, qy), fma(x, f.y.g.x, yy), fma(x, f.z.g.x, zy));
          fma(d, kept, less_error).store(g.corner_distance_sq[corner]);
          NearestOfLanes& best = found[corner];
          const WideFloat before = WideFloat::load(best.distance_sq);
          select(less(d, before), number, WideUint::load(best.group)).store(best.group);
          min(d, before).store(best.distance_sq);
        }
      }
    }
  }
  for (int n = 0; n < CandidateTable::kCorners; ++n) take_nearest(table, found[n], table.corners[n]);
}

// The eight corners of a cell, their references, and the squared distance below which a candidate beats a reference.
struct CellCorners {
  int number[8];                               // in the tile's lattice
  const CandidateTable::Corner* reference[8];  // by corner
  float limit[8][8];                           // by reference, by corner
  float reach_sq;
};

STANDOFF_INLINE CellCorners cell_corners(const BlockLattice& lattice, const CandidateTable& table,
                                         const int (&cell)[3]) {
  constexpr int kSide = CandidateTable::kCornersPerAxis;
  CellCorners result;
  const int(&number)[8] = result.number;
  for (int n = 0; n < 8; ++n)
    result.number[n] = cell[0] + (n & 1) + kSide * (cell[1] + (n >> 1 & 1) + kSide * (cell[2] + (n >> 2 & 1)));
  float diagonal_sq = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const float side = table.corners[number[7]].at[axis] - table.corners[number[0]].at[axis];
    diagonal_sq += side * side;
  }
  // No sample is farther than half the diagonal from the nearest corner.
  const float reach = (lattice.thickness + standoff::sqrt(diagonal_sq) / 2) * (1 + kSlackRatio);
  result.reach_sq = reach * reach;
  for (int q = 0; q < 8; ++q) {
    const CandidateTable::Corner& reference = table.corners[number[q]];
    result.reference[q] = &reference;
    for (int n = 0; n < 8; ++n) {
      const float* at = table.corners[number[n]].at;
      const float x = at[0] - reference.point[0], y = at[1] - reference.point[1], z = at[2] - reference.point[2];
      result.limit[q][n] = (x * x + y * y + z * z) * (1 + kSquareRounding) + reference.added_sq;
    }
  }
  return result;
}

// The lanes of a group that may be nearest to a sample of the cell.
STANDOFF_INLINE std::uint32_t chosen(const CandidateTable::Group& g, const CellCorners& cell) {
  WideFloat d[8];
  WideFloat least(__builtin_inff());
  for (int n = 0; n < 8; ++n) {
    d[n] = WideFloat::load(g.corner_distance_sq[cell.number[n]]);
    least = min(least, d[n]);
  }
  Mask may = ~less(WideFloat(cell.reach_sq), least) & mask_from_bits(g.lanes);
  for (int q = 0; q < 8 && may.to_bits() != 0; ++q) {
    Mask out = less(WideFloat(cell.limit[q][0]), d[0]);
    for (int n = 1; n < 8; ++n) out = out & less(WideFloat(cell.limit[q][n]), d[n]);
    may = may & ~out;
  }
  return may.to_bits();
}

// Lists the groups and lanes of a cell's candidates.
STANDOFF_INLINE void choose(CandidateTable& table, const CellCorners& cell) {
  table.active_groups = 0;
  for (int n = 0; n < table.count; ++n) {
    const std::uint32_t lanes = chosen(table.groups[n], cell);
    table.active[table.active_groups] = {static_cast<std::uint16_t>(n), static_cast<std::uint16_t>(lanes)};
    table.active_groups += lanes != 0;
  }
}

// How the blocks of a cell cull its candidates.
//
// Many candidates may be nearest to some point of a cell, but the cell has few samples. A point of any candidate bounds
// the distance of each sample from the surface. A block culls the candidates whose boxes are beyond this bound for each
// of its samples.

// The coordinates of a cell's samples: by block, and along the axes.
struct CellSamples {
  WideFloat x, y[kCellBlocks], z[kCellBlocks];
  float plane[3][kCellSide];
};

// The samples of the cell whose first sample is `at`, moved by `offset`.
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

// Squared distances of a cell's samples from the nearest point of the surface so far.
struct PointDistances {
  WideFloat least_sq[kBlocksOfCell];

  STANDOFF_INLINE PointDistances() {
    for (WideFloat& l : least_sq) l = WideFloat(__builtin_inff());
  }
  // Adds a point of the surface. If the point is only near the surface, `added_sq` raises its squared distances.
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

// `slack` and a `share` of the distance bound the errors of the points, of the boxes, and of distances from their
// triangles, all together.
STANDOFF_INLINE BlockLimits block_limits(const BlockLattice& lattice, const int (&at)[3], const PointDistances& points,
                                         float slack, float share, const BrickState& state) {
  const float within = lattice.thickness * (1 + kSlackRatio);
  BlockLimits limits;
  for (int n = 0; n < kBlocksOfCell; ++n) {
    const WideFloat before = min(WideFloat(within * within), WideFloat::load(state.distance_sq[block_of_cell(at, n)]));
    const WideFloat limit = fma(sqrt(min(before, points.least_sq[n])), WideFloat(1 + share), WideFloat(slack));
    (limit * limit).store(limits.distance_sq[n]);
  }
  return limits;
}

// Calls take(first, chosen) for each sixteen boxes from number `first` on; chosen[n] has a bit for each box that the
// n-th block keeps. The squared distance of a sample from a box is a sum of three numbers, one per axis, and a cell has
// only four different ones on each axis.
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
      WideFloat beyond(__builtin_inff());  // the least amount by which a sample's limit is exceeded
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
