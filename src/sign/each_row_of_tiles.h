// SPDX-License-Identifier: Apache-2.0
// All rows of tiles of a grid, with the samples inside.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstdint>

#include "core/per_thread.h"
#include "core/progress.h"
#include "core/tile_count.h"
#include "sign/sides.h"
#include "standoff/grid.h"

namespace standoff {

/// Calls use(rows, ty, tz) for each row of tiles, on the threads of the calling TBB arena. Throws Error{interrupted}.
template <class Use>
void for_each_row_of_tiles(Sides& sides, bool invert, const Grid& grid, ProgressMeter& progress, const Use& use) {
  PerThread<InsideRows> scratch([&] { return InsideRows(grid); });
  const std::int64_t tiles_y = tiles_along(grid.size.y), rows_of_tiles = tiles_y * tiles_along(grid.size.z);
  for (std::int64_t first = 0, end = 0; first < rows_of_tiles; first = end) {
    end = std::min(rows_of_tiles, sides.load(first));
    tbb::parallel_for(tbb::blocked_range<std::int64_t>(first, end, 8), [&](const auto& range) {
      progress.check();
      InsideRows& rows = scratch.local();
      for (std::int64_t n = range.begin(); n != range.end(); ++n) {
        const std::int64_t ty = n % tiles_y, tz = n / tiles_y;
        rows.clear(ty, tz);
        sides.fill(rows, ty, tz);
        if (invert) rows.invert();
        use(rows, ty, tz);
      }
    });
  }
}

}  // namespace standoff
