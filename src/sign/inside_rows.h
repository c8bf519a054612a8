// SPDX-License-Identifier: Apache-2.0
// Which samples of a row of tiles are inside, one bit each.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sign/row_crossings.h"
#include "standoff/grid.h"
#include "standoff/sign.h"

namespace standoff {

/// The 64 rows of the tiles (., ty, tz): eight samples to a byte, the first one in its lowest bit. Samples beyond the
/// grid are outside.
class InsideRows {
 public:
  InsideRows(const Grid& grid, const SignOptions& options);

  /// Fills the rows from their crossings. Returns whether any sample is inside.
  bool fill(std::span<const RowCrossing> crossings, std::int64_t ty, std::int64_t tz);

  /// Tile tx: a byte for each of its rows, y + 8 z.
  std::span<const std::uint8_t, 64> tile(std::int64_t tx) const {
    return std::span<const std::uint8_t, 64>(bits_.data() + 64 * tx, 64);
  }
  /// Whether all samples of the tile that are within the grid are inside.
  bool is_full(std::int64_t tx) const;
  /// Byte tx of a row.
  std::uint8_t byte(int row, std::int64_t tx) const { return bits_[static_cast<std::size_t>(64 * tx + row)]; }
  /// Whether the row is a row of the grid.
  bool in_grid(int row) const { return row % 8 < rows_y_ && row / 8 < rows_z_; }

 private:
  bool is_inside(std::int32_t winding) const;
  void set(int row, std::int64_t begin, std::int64_t end);

  Size3 size_;
  SignOptions options_;
  std::int64_t rows_y_ = 8, rows_z_ = 8;  // of the tiles, within the grid
  std::vector<std::uint8_t> bits_;        // by tile, then by row
};

}  // namespace standoff
