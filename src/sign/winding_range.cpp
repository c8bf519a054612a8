// SPDX-License-Identifier: Apache-2.0
#include "sign/winding_range.h"

#include <algorithm>

#include "core/tile_count.h"
#include "sign/row_crossings.h"

namespace standoff {
namespace {

// Samples in the middle of as many cells of the bounds.
Grid samples_in(const Box& bounds) {
  Grid grid;
  grid.size = {1024, 128, 128};
  const Vec3 cells{1024, 128, 128};
  Vec3 extent = bounds.extent();
  for (double* side : {&extent.x, &extent.y, &extent.z})
    if (!(*side > 0)) *side = 1;  // no sample can be inside
  grid.spacing = extent / cells;
  grid.origin = bounds.min + grid.spacing * 0.5;
  return grid;
}

}  // namespace

WindingRange find_winding_range(const OrientedMesh& mesh, const Box& bounds) {
  const ProgressCallback none;
  ProgressMeter progress(none);
  const Grid grid = samples_in(bounds);
  const RowCrossings crossings(mesh, grid, progress);
  WindingRange range;
  for (std::int64_t tz = 0; tz < tiles_along(grid.size.z); ++tz)
    for (std::int64_t ty = 0; ty < tiles_along(grid.size.y); ++ty) {
      const std::span<const RowCrossing> row = crossings.of_tiles(ty, tz);
      std::int32_t winding = 0;
      for (std::size_t n = 0; n < row.size(); ++n) {
        if (n > 0 && row[n].row() != row[n - 1].row()) winding = 0;
        winding += row[n].step();
        const bool last = n + 1 == row.size() || row[n + 1].row() != row[n].row() || row[n + 1].past() != row[n].past();
        if (!last) continue;
        range.least = std::min(range.least, winding);
        range.most = std::max(range.most, winding);
      }
    }
  return range;
}

}  // namespace standoff
