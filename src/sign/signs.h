// SPDX-License-Identifier: Apache-2.0
// What all sign methods have in common: which winding numbers are inside, which samples of a row of tiles are inside,
// and the interface that decides them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <span>
#include <vector>

#include "standoff/field.h"
#include "standoff/grid.h"
#include "standoff/sign.h"

namespace standoff {

struct RowCrossing;

/// Whether points with this generalised winding number are inside. Exactly at a threshold, a half-integer, the value of
/// smaller magnitude decides.
inline bool is_inside(double winding, WindingRule rule) {
  switch (rule) {
    case WindingRule::positive:
      return winding > 0.5;
    case WindingRule::nonzero:
      return std::abs(winding) > 0.5;
    case WindingRule::odd:
      return std::fmod(std::ceil(std::abs(winding) - 0.5), 2) == 1;
  }
  return false;
}

/// Whether samples with this winding number are inside.
constexpr bool is_inside(std::int32_t winding, WindingRule rule) {
  switch (rule) {
    case WindingRule::positive:
      return winding > 0;
    case WindingRule::nonzero:
      return winding != 0;
    case WindingRule::odd:
      return (winding & 1) != 0;
  }
  return false;
}

/// The distance of a generalised winding number from the nearest threshold.
inline double margin(double winding, WindingRule rule) {
  switch (rule) {
    case WindingRule::positive:
      return std::abs(winding - 0.5);
    case WindingRule::nonzero:
      return std::abs(std::abs(winding) - 0.5);
    case WindingRule::odd:
      return std::abs(winding - std::floor(winding) - 0.5);
  }
  return 0;
}

/// Which samples of the 64 rows of the tiles (., ty, tz) are inside: eight samples to a byte, the first one in its
/// lowest bit. Samples beyond the grid are outside. Of a window of the grid only the tiles along x that it has are
/// held; tiles and samples are counted from the grid's first one.
class InsideRows {
 public:
  static constexpr int kSide = 8;              ///< samples of a tile along an axis: the bits of a byte
  static constexpr int kRows = kSide * kSide;  ///< rows of a tile: row y + 8 z
  static_assert(kSide == DistanceField::kTileSide);

  explicit InsideRows(const Grid& grid) : InsideRows(grid, grid) {}
  /// Requires a window of whole tiles.
  InsideRows(const Grid& grid, const Grid& window);
  /// The memory that an object takes.
  static std::int64_t bytes(const Grid& grid);

  /// Begins with the tiles (., ty, tz): all their samples are outside.
  void clear(std::int64_t ty, std::int64_t tz);
  /// The tiles that are held.
  std::int64_t tiles_begin() const { return begin_; }
  std::int64_t tiles_end() const { return (size_.x + kSide - 1) / kSide; }
  /// Marks samples begin to end - 1 of a row that is in the grid, those that are held.
  void set(int row, std::int64_t begin, std::int64_t end);
  /// Marks the samples inside by the crossings of their rows, in any order, with a closed mesh. Requires that all
  /// samples are outside.
  void fill_between(std::span<const RowCrossing> crossings, WindingRule rule);
  /// Exchanges inside and outside within the grid.
  void invert();

  /// Tile tx: a byte for each of its rows.
  std::span<const std::uint8_t, kRows> tile(std::int64_t tx) const {
    return std::span<const std::uint8_t, kRows>(bits_.data() + place(tx), kRows);
  }
  /// The same for a caller that changes it.
  std::span<std::uint8_t, kRows> tile(std::int64_t tx) {
    first_tile_ = std::min(first_tile_, tx);
    end_of_tiles_ = std::max(end_of_tiles_, tx + 1);
    return std::span<std::uint8_t, kRows>(bits_.data() + place(tx), kRows);
  }
  /// The byte of a row of tile tx if all its samples are inside.
  std::uint8_t full_byte(int row, std::int64_t tx) const {
    return in_grid(row) ? static_cast<std::uint8_t>(0xff >> (kSide - samples_along_x(tx))) : std::uint8_t{0};
  }
  /// Whether no sample, or every sample, of the tile within the grid is inside.
  bool is_empty(std::int64_t tx) const;
  bool is_full(std::int64_t tx) const;
  /// All tiles that are not empty are from the first one to before the end.
  std::int64_t first_tile() const { return first_tile_; }
  std::int64_t end_of_tiles() const { return end_of_tiles_; }
  bool is_inside(int row, std::int64_t i) const {
    return (bits_[place(i / kSide) + static_cast<std::size_t>(row)] >> (i % kSide) & 1) != 0;
  }
  /// Whether the row is a row of the grid.
  bool in_grid(int row) const { return row % kSide < rows_y_ && row / kSide < rows_z_; }
  /// Of the grid; along x, of its part up to the last sample that is held.
  const Size3& size() const { return size_; }

 private:
  bool add_steps(std::span<const RowCrossing> crossings, WindingRule rule);
  std::size_t place(std::int64_t tx) const { return static_cast<std::size_t>(kRows * (tx - begin_)); }
  std::array<std::uint64_t, kRows / 8> words(std::int64_t tx) const;
  std::int64_t samples_along_x(std::int64_t tx) const { return std::min<std::int64_t>(kSide, size_.x - kSide * tx); }

  Size3 size_;
  std::int64_t begin_;                            // the first tile that is held
  std::int64_t rows_y_ = kSide, rows_z_ = kSide;  // of the tiles, within the grid
  std::int64_t first_tile_ = 0, end_of_tiles_ = 0;
  std::vector<std::uint8_t> bits_;        // by tile, then by row
  std::vector<std::int8_t> steps_;        // by sample, then by row
  std::vector<std::uint8_t> is_stepped_;  // by tile
};

/// A method that decides a sign: for each row of tiles it says which samples are inside.
class SampleSigns {
 public:
  SampleSigns() = default;
  SampleSigns(const SampleSigns&) = delete;
  SampleSigns& operator=(const SampleSigns&) = delete;
  virtual ~SampleSigns() = default;

  /// One thread calls it before fill(), with the number of a row of tiles, ty + tiles_y * tz: first 0, then the number
  /// that it returned last. It prepares the rows of tiles from `first` to before the number that it returns, and fill()
  /// is called for these rows only until the next load(). So memory can be bounded. Runs on the threads of the calling
  /// TBB arena.
  virtual std::int64_t load([[maybe_unused]] std::int64_t first) { return std::numeric_limits<std::int64_t>::max(); }

  /// Marks the samples that are inside in the tiles (., ty, tz), for which `rows` has been cleared. Many threads call
  /// it at once, each with rows of its own. Throws Error{interrupted} where a row of tiles may take long.
  virtual void fill(InsideRows& rows, std::int64_t ty, std::int64_t tz) const = 0;
};

}  // namespace standoff
