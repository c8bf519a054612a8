// SPDX-License-Identifier: Apache-2.0
// The crossings of a grid's rows, its lines of samples along x, with a mesh; and the integer winding numbers of closed
// meshes, which are their sums.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/progress.h"
#include "sign/oriented_mesh.h"
#include "sign/rows/row_scan.h"
#include "sign/signs.h"
#include "standoff/grid.h"
#include "standoff/sign.h"

namespace standoff {

/// A row crosses one or more triangles between two of its samples.
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
  /// The change of the winding number at that sample: 1 where the row enters the solid, -1 where it leaves it.
  std::int32_t step() const {
    return static_cast<std::int32_t>(key & ((std::uint64_t{1} << kStepBits) - 1)) -
           static_cast<std::int32_t>(kMostSteps);
  }
  friend auto operator<=>(const RowCrossing&, const RowCrossing&) = default;
};

/// The crossings of all rows of a grid, or of some rows of tiles at a time so that memory is bounded.
class RowCrossings {
 public:
  /// All crossings of the grid. Requires a valid mesh and grid, which outlive this. Runs on the threads of the calling
  /// TBB arena.
  RowCrossings(const OrientedMesh& mesh, const Grid& grid, ProgressMeter& progress);
  /// Of the crossings of a row of tiles.
  enum class Order : std::uint8_t { sorted, any };
  /// Holds no crossings yet. `bytes` limits the crossings held at a time; least_bytes if that is more.
  RowCrossings(const OrientedMesh& mesh, const Grid& grid, ProgressMeter& progress, std::int64_t bytes,
               Order order = Order::sorted);

  /// Replaces the crossings held by the crossings of the rows of tiles from number `first` on (ty + tiles_y * tz).
  /// Returns the number after the last row of tiles whose crossings fit. Runs on the threads of the calling TBB arena.
  /// Throws Error{interrupted}.
  std::int64_t load(std::int64_t first);

  /// The crossings of the 64 rows of the tiles (., ty, tz), in their order. Requires that they are held.
  std::span<const RowCrossing> of_tiles(std::int64_t ty, std::int64_t tz) const {
    const auto n = static_cast<std::size_t>(ty + tiles_y_ * tz - first_);
    return std::span(crossings_).subspan(begin_[n], begin_[n + 1] - begin_[n]);
  }

  std::int64_t rows_of_tiles() const { return rows_of_tiles_; }

  /// What all crossings of a grid take while they are found, about, if all of the mesh is beside the grid's rows.
  static double expected_bytes(const OrientedMesh& mesh, const Grid& grid);
  /// The least value of `bytes` for a mesh, which is enough for one row.
  static std::int64_t least_bytes(std::int64_t triangles, int threads);
  /// The most memory that is held beside the crossings.
  static std::int64_t other_bytes(std::int64_t triangles, const Grid& grid, int threads);

 private:
  bool find(std::int64_t first, std::int64_t count);
  bool find(const RowWindow& window, std::size_t count);
  void find_row_by_row(std::int64_t tiles);

  RowScan scan_;
  Order order_;
  std::size_t triangles_;
  Size3 size_;
  ProgressMeter* progress_;
  std::int64_t blocks_;  // in the lists of found crossings of all threads together
  std::int64_t tiles_y_, rows_of_tiles_;
  std::int64_t first_ = 0, try_;    // the first row of tiles that is held; the number of rows to try at once
  std::vector<std::size_t> begin_;  // by row of tiles
  std::vector<RowCrossing> crossings_;
};

/// The signs in a closed mesh: its winding number is an integer, the sum of the crossings of a row.
class IntegerWinding final : public SampleSigns {
 public:
  /// Requires a mesh that is closed in the orientation given, or, for WindingRule::odd, an even number of triangles at
  /// each edge. Runs on the threads of the calling TBB arena. Throws Error{interrupted}.
  /// `bytes` limits the crossings held at a time (RowCrossings).
  IntegerWinding(const OrientedMesh& mesh, const Grid& grid, WindingRule rule, ProgressMeter& progress,
                 std::int64_t bytes = std::numeric_limits<std::int64_t>::max())
      : crossings_(mesh, grid, progress, bytes, RowCrossings::Order::any), rule_(rule) {}

  std::int64_t load(std::int64_t first) override { return crossings_.load(first); }
  void fill(InsideRows& rows, std::int64_t ty, std::int64_t tz) const override {
    rows.fill_between(crossings_.of_tiles(ty, tz), rule_);
  }

 private:
  RowCrossings crossings_;
  WindingRule rule_;
};

}  // namespace standoff
