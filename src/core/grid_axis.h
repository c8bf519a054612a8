// SPDX-License-Identifier: Apache-2.0
// One axis of a grid. All samples of a window of a grid get the coordinates that the whole grid gives them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "standoff/grid.h"

namespace standoff {

struct GridAxis {
  double origin, spacing;    ///< of the whole grid, world units
  std::int64_t first, size;  ///< the window's first sample and its samples

  /// The coordinate of sample n, as Grid::position() gives it.
  constexpr double at(std::int64_t n) const { return origin + spacing * static_cast<double>(first + n); }
};

/// Axis 0, 1 or 2.
inline GridAxis axis_of(const Grid& grid, std::size_t axis) {
  return {grid.origin[axis], grid.spacing[axis], grid.first[axis], grid.size[axis]};
}
inline std::array<GridAxis, 3> axes_of(const Grid& grid) {
  return {axis_of(grid, 0), axis_of(grid, 1), axis_of(grid, 2)};
}

}  // namespace standoff
