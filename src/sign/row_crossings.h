// SPDX-License-Identifier: Apache-2.0
// Where the rows of a grid cross a mesh: all crossings of the triangles with the lines of samples along x.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/progress.h"
#include "sign/inside_rows.h"
#include "sign/oriented_mesh.h"
#include "standoff/grid.h"

namespace standoff {

/// A row of the grid crosses a triangle between two of its samples.
struct RowCrossing {
  std::uint64_t key;  ///< sorts by row, then along the row

  static RowCrossing make(int row, std::int64_t past, int crossing) {
    return {std::uint64_t(row) << 58 | std::uint64_t(past) << 1 | std::uint64_t(crossing < 0)};
  }
  /// The row in the tile, y + 8 z.
  int row() const { return static_cast<int>(key >> 58); }
  /// The first sample past the triangle.
  std::int64_t past() const { return static_cast<std::int64_t>(key << 6 >> 7); }
  /// What the winding number changes by at that sample: 1 where the row enters the solid, -1 where it leaves it.
  int step() const { return (key & 1) != 0 ? 1 : -1; }
  friend auto operator<=>(const RowCrossing&, const RowCrossing&) = default;
};

/// The crossings of a grid, by row of tiles.
class RowCrossings {
 public:
  /// Requires a valid mesh and grid. Runs on the threads of the calling TBB arena.
  RowCrossings(const OrientedMesh& mesh, const Grid& grid, ProgressMeter& progress);

  /// Those of the 64 rows of the tiles (., ty, tz), sorted.
  std::span<const RowCrossing> of_tiles(std::int64_t ty, std::int64_t tz) const {
    const auto row = static_cast<std::size_t>(ty + tiles_y_ * tz);
    return std::span(crossings_).subspan(begin_[row], begin_[row + 1] - begin_[row]);
  }

 private:
  std::int64_t tiles_y_;
  std::vector<std::size_t> begin_;  // by row of tiles
  std::vector<RowCrossing> crossings_;
};

}  // namespace standoff
