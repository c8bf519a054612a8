// SPDX-License-Identifier: Apache-2.0
// The rows of tiles of a grid, with the samples inside.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstdint>

#include "core/progress.h"
#include "core/threads.h"
#include "core/tile_count.h"
#include "sign/sides.h"
#include "standoff/grid.h"

namespace standoff {

/// Goes through the rows of tiles once, as many layers of tiles at a time as are asked for. What the sides have loaded
/// serves as many layers as it holds. All on the threads of the TBB arena that this is made in.
class RowsOfTiles {
 public:
  RowsOfTiles(Sides& sides, bool invert, const Grid& grid, ProgressMeter& progress)
      : sides_(sides),
        invert_(invert),
        tiles_y_(tiles_along(grid.size.y)),
        all_(tiles_y_ * tiles_along(grid.size.z)),
        progress_(progress),
        scratch_([&grid] { return InsideRows(grid); }) {}

  /// Calls use(rows, ty, tz) for each row of tiles of the next layers. Throws Error{interrupted}.
  template <class Use>
  void next_layers(std::int64_t layers, const Use& use) {
    for (const std::int64_t end = std::min(all_, next_ + layers * tiles_y_); next_ < end;) {
      if (next_ == loaded_) loaded_ = std::min(all_, sides_.load(next_));
      const std::int64_t stop = std::min(end, loaded_);
      tbb::parallel_for(tbb::blocked_range<std::int64_t>(next_, stop, 8), [&](const auto& range) {
        InsideRows& rows = scratch_.local();
        for (std::int64_t n = range.begin(); n != range.end(); ++n) {
          progress_.check();  // a range may be many rows
          const std::int64_t ty = n % tiles_y_, tz = n / tiles_y_;
          rows.clear(ty, tz);
          sides_.fill(rows, ty, tz);
          if (invert_) rows.invert();
          use(rows, ty, tz);
        }
      });
      next_ = stop;
    }
  }

 private:
  Sides& sides_;
  bool invert_;
  std::int64_t tiles_y_, all_;
  ProgressMeter& progress_;
  PerThread<InsideRows> scratch_;
  std::int64_t next_ = 0, loaded_ = 0;  // numbers of rows of tiles
};

/// Calls use(rows, ty, tz) for each row of tiles, on the threads of the calling TBB arena. Throws Error{interrupted}.
template <class Use>
void for_each_row_of_tiles(Sides& sides, bool invert, const Grid& grid, ProgressMeter& progress, const Use& use) {
  RowsOfTiles(sides, invert, grid, progress).next_layers(tiles_along(grid.size.z), use);
}

}  // namespace standoff
