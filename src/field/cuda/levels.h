// SPDX-License-Identifier: Apache-2.0
// The cells that candidates are passed down through: level 0 are the tiles, each level above joins 2x2x2 cells, the
// last is one cell.
#pragma once

#include "field/lattice.h"

namespace standoff {

struct Level {
  std::int64_t side;  // of a cell, samples
  std::int64_t cells[3];

  STANDOFF_HD std::int64_t count() const { return cells[0] * cells[1] * cells[2]; }
};

inline Level level_of(const Lattice& l, int number) {
  Level level{std::int64_t{kTileSide} << number, {}};
  for (int axis = 0; axis < 3; ++axis) level.cells[axis] = (l.size[axis] + level.side - 1) / level.side;
  return level;
}

/// The number of the level that is one cell.
inline int top_level(const Lattice& l) {
  int number = 0;
  while (level_of(l, number).count() > 1) ++number;
  return number;
}

/// The samples of a cell inside the grid, as a box around them. Grid units.
struct CellBox {
  Triple<double> center;
  float half[3], radius;  // with a margin for rounding
};

STANDOFF_INLINE CellBox cell_at(const Lattice& l, const Level& level, const std::int64_t* at) {
  CellBox cell;
  double middle[3];
  float radius_sq = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const std::int64_t first = at[axis] * level.side;
    const std::int64_t past = first + level.side < l.size[axis] ? first + level.side : l.size[axis];
    middle[axis] = static_cast<double>(first + past - 1) / 2;
    cell.half[axis] = static_cast<float>(static_cast<double>(past - 1 - first) / 2 * l.unit[axis]) * (1 + kSlackRatio);
    radius_sq += cell.half[axis] * cell.half[axis];
  }
  cell.center = position(l, middle[0], middle[1], middle[2]);
  cell.radius = sqrt(radius_sq);
  return cell;
}

}  // namespace standoff
