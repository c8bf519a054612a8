// SPDX-License-Identifier: Apache-2.0
// Which samples of a row of tiles are inside, one bit each.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "standoff/field.h"
#include "standoff/grid.h"

namespace standoff {

/// The 64 rows of the tiles (., ty, tz): eight samples to a byte, the first one in its lowest bit. Samples beyond the
/// grid are outside.
class InsideRows {
 public:
  static constexpr int kSide = 8;              ///< samples of a tile along an axis: the bits of a byte
  static constexpr int kRows = kSide * kSide;  ///< rows of a tile: row y + 8 z
  static_assert(kSide == DistanceField::kTileSide);

  explicit InsideRows(const Grid& grid);
  /// What one takes.
  static std::int64_t bytes(const Grid& grid);

  /// All samples of the tiles (., ty, tz) are outside.
  void clear(std::int64_t ty, std::int64_t tz);
  /// Marks samples begin to end - 1 of a row that is in the grid. Requires begin < end.
  void set(int row, std::int64_t begin, std::int64_t end);
  /// Exchanges inside and outside from a sample of a row on, if `really`. Takes effect with finish_toggles().
  void toggle(int row, std::int64_t from, bool really) {
    const std::int64_t tx = from / kSide;
    first_tile_ = std::min(first_tile_, tx);
    bits_[static_cast<std::size_t>(kRows * tx + row)] ^=
        static_cast<std::uint8_t>((0xff << from % kSide) & -int{really});
  }
  /// Requires that the samples toggled were outside, and that nothing else was set.
  void finish_toggles();
  /// Exchanges inside and outside within the grid.
  void invert();

  /// Tile tx: a byte for each of its rows.
  std::span<const std::uint8_t, kRows> tile(std::int64_t tx) const {
    return std::span<const std::uint8_t, kRows>(bits_.data() + kRows * tx, kRows);
  }
  /// To be changed.
  std::span<std::uint8_t, kRows> tile(std::int64_t tx) {
    first_tile_ = std::min(first_tile_, tx);
    end_of_tiles_ = std::max(end_of_tiles_, tx + 1);
    return std::span<std::uint8_t, kRows>(bits_.data() + kRows * tx, kRows);
  }
  /// The byte of a row of tile tx if all its samples are inside.
  std::uint8_t full_byte(int row, std::int64_t tx) const {
    return in_grid(row) ? static_cast<std::uint8_t>(0xff >> (kSide - samples_along_x(tx))) : std::uint8_t{0};
  }
  /// Whether no, or every, sample of the tile that is within the grid is inside.
  bool is_empty(std::int64_t tx) const;
  bool is_full(std::int64_t tx) const;
  /// All tiles that are not empty are from this one to before that one.
  std::int64_t first_tile() const { return first_tile_; }
  std::int64_t end_of_tiles() const { return end_of_tiles_; }
  bool is_inside(int row, std::int64_t i) const {
    return (bits_[static_cast<std::size_t>(kRows * (i / kSide) + row)] >> (i % kSide) & 1) != 0;
  }
  /// Whether the row is a row of the grid.
  bool in_grid(int row) const { return row % kSide < rows_y_ && row / kSide < rows_z_; }
  const Size3& size() const { return size_; }

 private:
  std::int64_t samples_along_x(std::int64_t tx) const { return std::min<std::int64_t>(kSide, size_.x - kSide * tx); }

  Size3 size_;
  std::int64_t rows_y_ = kSide, rows_z_ = kSide;  // of the tiles, within the grid
  std::int64_t first_tile_ = 0, end_of_tiles_ = 0;
  std::vector<std::uint8_t> bits_;  // by tile, then by row
};

}  // namespace standoff
