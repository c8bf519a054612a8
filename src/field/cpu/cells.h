// SPDX-License-Identifier: Apache-2.0
// The cells that candidates are handed down through: the grid, its halves, and theirs.
#pragma once

#include <tbb/blocked_range.h>

#include <algorithm>
#include <cstdint>

#include "field/backend.h"
#include "field/cpu/lattice.h"

namespace standoff::cpu {

/// Samples [low, high) per axis of the grid, 2^n of them on a side before the grid cuts it.
struct Cell {
  std::int64_t low[3], high[3];
  std::int64_t side;

  friend bool operator==(const Cell&, const Cell&) = default;
};

/// The cell that holds all samples.
inline Cell whole_grid(const BlockLattice& lattice) {
  Cell whole{{0, 0, 0}, {lattice.size[0], lattice.size[1], lattice.size[2]}, kBrickSide};
  while (whole.side < *std::max_element(lattice.size, lattice.size + 3)) whole.side *= 2;
  return whole;
}

/// How many cells lie within one another from the grid to a brick, both counted.
inline int levels_of(const BlockLattice& lattice) {
  int levels = 1;
  for (std::int64_t side = whole_grid(lattice).side; side > kBrickSide; side /= 2) ++levels;
  return levels;
}

/// The eight or fewer halves of a cell; returns how many.
inline int halves(const Cell& cell, Cell (&parts)[8]) {
  int count = 0;
  const std::int64_t half = cell.side / 2;
  for (int n = 0; n < 8; ++n) {
    Cell& part = parts[count];
    part.side = half;
    bool some = true;
    for (int axis = 0; axis < 3; ++axis) {
      part.low[axis] = cell.low[axis] + ((n >> axis & 1) != 0 ? half : 0);
      part.high[axis] = std::min(part.low[axis] + half, cell.high[axis]);
      some = some && part.low[axis] < part.high[axis];
    }
    count += some;
  }
  return count;
}

/// Which of a brick's tiles a half of it is.
inline int tile_in(const Cell& brick, const Cell& tile) {
  int number = 0;
  for (int axis = 0; axis < 3; ++axis) number += tile.low[axis] > brick.low[axis] ? 1 << axis : 0;
  return number;
}

/// Bricks [low, high) per axis: what one thread does, until another wants half of it (TBB's Range). It is cut where
/// cells are, across its longest side, so that what a thread does lies together.
class BrickRange {
 public:
  BrickRange(const BlockLattice& lattice, const BrickLayers& layers)
      : low_{0, 0, layers.begin}, high_{lattice.bricks[0], lattice.bricks[1], layers.end} {}
  BrickRange(BrickRange& other, tbb::split) : BrickRange(other) {
    const int axis = other.longest();
    std::int64_t step = 1;
    while ((other.low_[axis] / (2 * step) + 1) * (2 * step) < other.high_[axis]) step *= 2;
    low_[axis] = other.high_[axis] = (other.low_[axis] / step + 1) * step;
  }

  bool empty() const { return false; }
  bool is_divisible() const { return high_[longest()] - low_[longest()] > 1; }

  /// How many bricks of the cell are in the range.
  std::int64_t bricks_of(const Cell& cell) const {
    std::int64_t count = 1;
    for (int axis = 0; axis < 3; ++axis) {
      const std::int64_t first = std::max(low_[axis], cell.low[axis] / kBrickSide);
      const std::int64_t last = std::min(high_[axis] - 1, (cell.high[axis] - 1) / kBrickSide);
      count *= std::max<std::int64_t>(0, last - first + 1);
    }
    return count;
  }

 private:
  int longest() const {
    int best = 0;
    for (int axis = 1; axis < 3; ++axis)
      if (high_[axis] - low_[axis] >= high_[best] - low_[best]) best = axis;
    return best;
  }

  std::int64_t low_[3], high_[3];
};

}  // namespace standoff::cpu
