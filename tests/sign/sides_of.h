// SPDX-License-Identifier: Apache-2.0
// All samples of a grid, asked of what decides their sides.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "core/tile_count.h"
#include "sign/signs.h"

namespace standoff::testing {

/// Whether each sample is inside, x fastest. Samples beyond the grid must be outside.
inline std::vector<bool> sides_of(SampleSigns& sides, const Grid& grid) {
  sides.load(0);  // everything at once
  std::vector<bool> inside(static_cast<std::size_t>(grid.sample_count()));
  InsideRows rows(grid);
  for (std::int64_t tz = 0; tz < tiles_along(grid.size.z); ++tz)
    for (std::int64_t ty = 0; ty < tiles_along(grid.size.y); ++ty) {
      rows.clear(ty, tz);
      sides.fill(rows, ty, tz);
      for (int row = 0; row < InsideRows::kRows; ++row)
        for (std::int64_t i = 0; i < InsideRows::kSide * tiles_along(grid.size.x); ++i) {
          const std::int64_t j = 8 * ty + row % 8, k = 8 * tz + row / 8;
          const bool in_grid = i < grid.size.x && j < grid.size.y && k < grid.size.z;
          if (in_grid) inside[static_cast<std::size_t>(grid.index(i, j, k))] = rows.is_inside(row, i);
          EXPECT_TRUE(in_grid || !rows.is_inside(row, i));
        }
    }
  return inside;
}

}  // namespace standoff::testing
