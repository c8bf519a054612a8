// SPDX-License-Identifier: Apache-2.0
// Boxes of samples of a grid.
#pragma once

#include <array>
#include <cstdint>

#include "sign/open_winding/linear_field.h"
#include "standoff/grid.h"

namespace standoff {

/// Samples begin to end - 1 along each axis.
struct SampleBox {
  std::array<std::int64_t, 3> begin, end;
};

/// The cell of a box of samples. It is larger by a thousandth of the spacing, and by more than positions are rounded.
inline Cell cell_of(const Grid& grid, const SampleBox& box) {
  const Vec3 low = grid.position(box.begin[0], box.begin[1], box.begin[2]),
             high = grid.position(box.end[0] - 1, box.end[1] - 1, box.end[2] - 1);
  const double rounding = 1e-15 * (max_norm(low) + max_norm(high));
  const Vec3 half = (high - low) * 0.5 + grid.spacing * 1e-3 + Vec3{rounding, rounding, rounding};
  return {low + (high - low) * 0.5, half, length(half)};
}

}  // namespace standoff
