// SPDX-License-Identifier: Apache-2.0
// Where the rows of a grid cross a mesh: all crossings of the triangles with the lines of samples along x.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/progress.h"
#include "sign/inside_rows.h"
#include "sign/oriented_mesh.h"
#include "sign/rows/row_scan.h"
#include "standoff/grid.h"

namespace standoff {

/// Between two of its samples a row crosses one or more triangles.
struct RowCrossing {
  std::uint64_t key;  ///< sorts by row, then along the row

  static constexpr int kPastBits = 40, kStepBits = 18;
  static constexpr std::int64_t kMostSteps = (std::int64_t{1} << (kStepBits - 1)) - 1;

  /// Requires |step| <= kMostSteps.
  static RowCrossing make(std::uint64_t row, std::int64_t past, std::int64_t step) {
    return {row << (kPastBits + kStepBits) | std::uint64_t(past) << kStepBits | std::uint64_t(step + kMostSteps)};
  }
  /// The row in the tile, y + 8 z.
  int row() const { return static_cast<int>(key >> (kPastBits + kStepBits)); }
  /// The first sample past the triangles.
  std::int64_t past() const { return static_cast<std::int64_t>(key << 6 >> (6 + kStepBits)); }
  /// What the winding number changes by at that sample: 1 where the row enters the solid, -1 where it leaves it.
  std::int32_t step() const {
    return static_cast<std::int32_t>(key & ((std::uint64_t{1} << kStepBits) - 1)) -
           static_cast<std::int32_t>(kMostSteps);
  }
  friend auto operator<=>(const RowCrossing&, const RowCrossing&) = default;
};

/// The crossings of a grid's rows, or of as many rows of tiles at a time as memory is meant to hold.
class RowCrossings {
 public:
  /// All crossings of the grid. Requires a valid mesh and grid, which outlive this. Runs on the threads of the calling
  /// TBB arena.
  RowCrossings(const OrientedMesh& mesh, const Grid& grid, ProgressMeter& progress);
  /// None yet. `bytes`: what all crossings held at a time may take, or least_bytes if that is more.
  RowCrossings(const OrientedMesh& mesh, const Grid& grid, ProgressMeter& progress, std::int64_t bytes);

  /// Finds the crossings of the rows of tiles from number `first` on (ty + tiles_y * tz), in place of those held, and
  /// returns the number after the last one whose crossings fit. Runs on the threads of the calling TBB arena. Throws
  /// Error{interrupted}.
  std::int64_t load(std::int64_t first);

  /// Those of the 64 rows of the tiles (., ty, tz), sorted. Requires that they are held.
  std::span<const RowCrossing> of_tiles(std::int64_t ty, std::int64_t tz) const {
    const auto n = static_cast<std::size_t>(ty + tiles_y_ * tz - first_);
    return std::span(crossings_).subspan(begin_[n], begin_[n + 1] - begin_[n]);
  }

  /// The least that `bytes` may be for a mesh of so many triangles, which is enough for one row; and what is held
  /// beside them at most.
  static std::int64_t least_bytes(std::int64_t triangles, int threads);
  static std::int64_t other_bytes(std::int64_t triangles, const Grid& grid, int threads);

 private:
  bool find(std::int64_t first, std::int64_t count);
  bool find(const RowWindow& window, std::size_t count);
  void find_row_by_row(std::int64_t tiles);

  RowScan scan_;
  std::size_t triangles_;
  Size3 size_;
  ProgressMeter* progress_;
  std::int64_t blocks_;  // of lists of found crossings, all threads together
  std::int64_t tiles_y_, rows_of_tiles_;
  std::int64_t first_ = 0, try_;    // the first row of tiles that is held; how many are tried at once
  std::vector<std::size_t> begin_;  // by row of tiles
  std::vector<RowCrossing> crossings_;
};

}  // namespace standoff
