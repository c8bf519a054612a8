// SPDX-License-Identifier: Apache-2.0
#include "sign/integer_winding.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>

#include "core/tile_count.h"

namespace standoff {

void IntegerWinding::fill(InsideRows& rows, std::int64_t ty, std::int64_t tz) const {
  const std::int64_t size = rows.size().x;
  const std::span<const RowCrossing> crossings = crossings_.of_tiles(ty, tz);
  for (auto next = crossings.begin(); next != crossings.end();) {
    const int row = next->row();
    std::int32_t winding = 0;
    std::int64_t from = 0;
    for (; next != crossings.end() && next->row() == row; ++next) {
      if (next->past() != from && is_inside(winding, rule_)) rows.set(row, from, next->past());
      from = next->past();
      winding += next->step();
    }
    if (from < size && is_inside(winding, rule_)) rows.set(row, from, size);
  }
}

std::int32_t IntegerWinding::least_winding() const {
  const std::int64_t tiles_y = tiles_along(grid_size_.y), rows_of_tiles = tiles_y * tiles_along(grid_size_.z);
  return tbb::parallel_reduce(
      tbb::blocked_range<std::int64_t>(0, rows_of_tiles, 64), 0,
      [&](const auto& range, std::int32_t least) {
        for (std::int64_t n = range.begin(); n != range.end(); ++n) {
          std::int32_t winding = 0;
          int row = -1;
          const std::span<const RowCrossing> crossings = crossings_.of_tiles(n % tiles_y, n / tiles_y);
          for (std::size_t c = 0; c < crossings.size(); ++c) {
            if (crossings[c].row() != row) winding = 0, row = crossings[c].row();
            winding += crossings[c].step();
            // Several crossings may lie between two samples.
            const bool reaches_sample = c + 1 == crossings.size() || crossings[c + 1].row() != row ||
                                        crossings[c + 1].past() != crossings[c].past();
            if (reaches_sample) least = std::min(least, winding);
          }
        }
        return least;
      },
      [](std::int32_t a, std::int32_t b) { return std::min(a, b); });
}

}  // namespace standoff
