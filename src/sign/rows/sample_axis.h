// SPDX-License-Identifier: Apache-2.0
// The samples of one axis of a grid, and the search for the first one where a predicate turns true, from a guess that
// is nearly always right. For host and device.
#pragma once

#include <cstdint>

#include "core/grid_axis.h"
#include "geometry/host_device.h"

namespace standoff {

/// The first of `size` samples at or above `place`, which counts samples from the first one; or `size`. Rounds up
/// without ceil(), which is a call where there is no SSE4.1.
STANDOFF_HD inline std::int64_t sample_at_or_above(double place, std::int64_t size) {
  if (!(place > 0)) return 0;
  if (!(place < static_cast<double>(size))) return size;
  const auto below = static_cast<std::int64_t>(place);
  return below + (static_cast<double>(below) < place);
}

/// The first n in [0, size) for which is_true(n), or `size`. is_true must stay true once it is. Takes two calls where
/// the guess is right, and a logarithm of its error otherwise.
template <class Predicate>
STANDOFF_HD std::int64_t first_from_guess(std::int64_t guess, std::int64_t size, const Predicate& is_true) {
  std::int64_t low = guess - 1, high = guess;  // false at low, true at high, where low < 0 is false and size is true
  for (std::int64_t step = 1; low >= 0 && is_true(low); step *= 2) {
    high = low;
    low -= step;
  }
  for (std::int64_t step = 1; high < size && !is_true(high); step *= 2) {
    low = high;
    high += step;
  }
  low = low > -1 ? low : -1;
  high = high < size ? high : size;
  while (high - low > 1) {
    const std::int64_t middle = low + (high - low) / 2;
    (is_true(middle) ? high : low) = middle;
  }
  return high;
}

/// The samples of one axis of a grid, as Grid::position gives them.
class SampleAxis {
 public:
  STANDOFF_HD explicit SampleAxis(const GridAxis& axis)
      : axis_(axis), first_(static_cast<double>(axis.first)), per_spacing_(1 / axis.spacing) {}

  STANDOFF_HD std::int64_t size() const { return axis_.size; }
  STANDOFF_HD double at(std::int64_t n) const { return axis_.at(n); }
  /// The number of samples from the first one to `value`, rounded.
  STANDOFF_HD double to_samples(double value) const { return (value - axis_.origin) * per_spacing_ - first_; }
  /// The first sample for which is_true, which stays true: near `value`, or the number of samples.
  template <class Predicate>
  STANDOFF_HD std::int64_t first(double value, const Predicate& is_true) const {
    return first_from_guess(sample_at_or_above(to_samples(value), axis_.size), axis_.size, is_true);
  }
  /// The first sample at or above `value`, or the number of samples.
  STANDOFF_HD std::int64_t first_from(double value) const {
    return first(value, [&](std::int64_t n) { return at(n) >= value; });
  }

 private:
  GridAxis axis_;
  double first_, per_spacing_;
};

}  // namespace standoff
