// SPDX-License-Identifier: Apache-2.0
// A grid in whole tiles, and tiles around it: the samples between which paths are searched.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "sign/rows/first_from_guess.h"
#include "standoff/field.h"
#include "standoff/grid.h"

namespace standoff {

/// The samples of one axis. Those of the grid are where Grid::position says. Samples before and after them have the
/// same spacing, or one that doubles from each sample to the next.
class LatticeAxis {
 public:
  /// So many samples before the grid's and after them.
  struct Margin {
    std::int64_t before = 0, after = 0;
    bool doubling = false;
  };
  LatticeAxis(double origin, double spacing, std::int64_t grid_size, const Margin& margin);

  std::int64_t size() const { return size_; }
  double at(std::int64_t n) const {
    if (n < first_even_) return even(first_even_) - spacing_ * doublings(first_even_ - n);
    if (n > last_even_) return even(last_even_) + spacing_ * doublings(n - last_even_);
    return even(n);
  }
  /// The first sample for which is_true, which stays true: near `value`, or size().
  template <class Predicate>
  std::int64_t first(double value, const Predicate& is_true) const {
    return first_from_guess(guess(value), size_, is_true);
  }
  /// The first sample at or above `value`, or size().
  std::int64_t first_from(double value) const {
    return first(value, [&](std::int64_t n) { return at(n) >= value; });
  }

 private:
  double even(std::int64_t n) const { return origin_ + spacing_ * static_cast<double>(n - before_); }
  static double doublings(std::int64_t samples);  // 1 + 2 + 4 + ..
  std::int64_t guess(double value) const {
    return sample_at_or_above((value - origin_) * per_spacing_ + static_cast<double>(before_), size_);
  }

  double origin_, spacing_, per_spacing_;
  std::int64_t before_, size_;
  std::int64_t first_even_, last_even_;  // beyond them spacings double
};

struct TileLattice {
  /// The tiles of a grid. Samples of the last tiles that are beyond the grid continue its spacing.
  static TileLattice of(const Grid& grid);
  /// The same, with more tiles wherever the box does not end within the outermost samples. So those samples are all
  /// outside the box. The tiles added continue the grid's spacing if they are not many more than the grid's: at most
  /// eight times as many, or 2^18 in all. Otherwise the spacing doubles from sample to sample, so that a box of any
  /// size takes few.
  static TileLattice around(const Grid& grid, const Box& box);

  std::array<LatticeAxis, 3> axes;
  Size3 tiles;   ///< along each axis
  Size3 origin;  ///< where the grid's first tile is

  std::size_t tile_count() const { return static_cast<std::size_t>(tiles.x * tiles.y * tiles.z); }
  std::size_t index(std::int64_t tx, std::int64_t ty, std::int64_t tz) const {
    return static_cast<std::size_t>(tx + tiles.x * (ty + tiles.y * tz));
  }
  std::array<std::int64_t, 3> tile_at(std::size_t index) const {
    const auto n = static_cast<std::int64_t>(index);
    return {n % tiles.x, n / tiles.x % tiles.y, n / (tiles.x * tiles.y)};
  }
  /// The tile (tx, ty, tz) of the grid.
  std::size_t index_in_grid(std::int64_t tx, std::int64_t ty, std::int64_t tz) const {
    return index(tx + origin.x, ty + origin.y, tz + origin.z);
  }
};

}  // namespace standoff
