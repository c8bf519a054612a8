// SPDX-License-Identifier: Apache-2.0
// Which cells a triangle has to be looked at in, on the CPU (bricks) and on the GPU (tiles): first those that its box
// grown by the thickness touches; of a long triangle, which misses most cells of its box, those whose centre is near
// enough.
#pragma once

#include "field/lattice.h"
#include "geometry/triangle_box.h"
#include "geometry/triangle_frame.h"

namespace standoff {

/// Cells low[axis] to high[axis], both included; low > high on some axis for none.
struct CellRange {
  std::int64_t low[3], high[3];

  STANDOFF_HD bool empty() const { return low[0] > high[0] || low[1] > high[1] || low[2] > high[2]; }
  /// At most two in a row: a triangle of so few is put into all of them.
  STANDOFF_HD bool is_small() const { return high[0] - low[0] <= 1 && high[1] - low[1] <= 1 && high[2] - low[2] <= 1; }
};

/// The cells of kSide samples on a side that hold samples of the box (world units) grown by the lattice's thickness.
template <int kSide>
STANDOFF_INLINE CellRange reached_cells(const Lattice& l, const BoxOf<double>& box) {
  const double lows[3] = {box.low.x, box.low.y, box.low.z}, highs[3] = {box.high.x, box.high.y, box.high.z};
  CellRange range;
  for (int axis = 0; axis < 3; ++axis) {
    const double past = static_cast<double>(l.size[axis]);
    const double from = (lows[axis] - l.origin[axis]) * l.to_samples[axis] - l.reach[axis];
    const double to = (highs[axis] - l.origin[axis]) * l.to_samples[axis] + l.reach[axis];
    // The first sample at or above `from` and the last at or below `to`, by truncation of what is not negative.
    const auto first = static_cast<std::int64_t>(min(max(from + (1 - kBoxSlack), 0.0), past));
    const auto last = static_cast<std::int64_t>(min(max(to + 1, 0.0), past)) - 1;
    range.low[axis] = first / kSide;
    range.high[axis] = last < first ? -1 : last / kSide;
  }
  return range;
}

/// Squared: how near the centre of a cell is to a triangle that lies within the thickness of some of its samples, at
/// most. Grid units.
template <int kSide>
STANDOFF_INLINE double cell_reach_sq(const Lattice& l) {
  double radius_sq = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double half = l.unit[axis] * (kSide - 1) / 2;
    radius_sq += half * half;
  }
  const double reach = (l.thickness_units + sqrt(radius_sq)) * (1 + kBoxSlack);
  return reach * reach;
}

/// A long triangle relative to the centre of the first cell of its range.
template <int kSide>
struct LongTriangle {
  TriangleFrame<double> frame;
  CellRange range;

  /// Corners in world units.
  STANDOFF_INLINE LongTriangle(const Lattice& l, const CellRange& cells, const Triple<double> (&corner)[3])
      : range(cells) {
    const Triple<double> first = cell_center<kSide>(l, cells.low[0], cells.low[1], cells.low[2]);
    frame = make_frame(local(l, corner[0], first), local(l, corner[1], first), local(l, corner[2], first),
                       double{kLeastLengthSqOfCells});
  }

  /// Whether it is within cell_reach_sq() of the centre of a cell.
  STANDOFF_INLINE bool reaches(const Lattice& l, std::int64_t x, std::int64_t y, std::int64_t z,
                               double reach_sq) const {
    const Triple<double> center{l.unit[0] * kSide * static_cast<double>(x - range.low[0]),
                                l.unit[1] * kSide * static_cast<double>(y - range.low[1]),
                                l.unit[2] * kSide * static_cast<double>(z - range.low[2])};
    return distance_sq(frame, center) <= reach_sq;
  }
};

}  // namespace standoff
