// SPDX-License-Identifier: Apache-2.0
// The samples of one axis of a grid, as Grid::position gives them.
#pragma once

#include <cstdint>

#include "sign/rows/first_from_guess.h"

namespace standoff {

class SampleAxis {
 public:
  SampleAxis(double origin, double spacing, std::int64_t size)
      : origin_(origin), spacing_(spacing), per_spacing_(1 / spacing), size_(size) {}

  std::int64_t size() const { return size_; }
  double at(std::int64_t n) const { return origin_ + spacing_ * static_cast<double>(n); }
  /// The number of samples from the first one to `value`, rounded.
  double to_samples(double value) const { return (value - origin_) * per_spacing_; }
  /// The first sample for which is_true, which stays true: near `value`, or the number of samples.
  template <class Predicate>
  std::int64_t first(double value, const Predicate& is_true) const {
    return first_from_guess(guess(value), size_, is_true);
  }
  /// The first sample at or above `value`, or the number of samples.
  std::int64_t first_from(double value) const {
    return first(value, [&](std::int64_t n) { return at(n) >= value; });
  }

 private:
  // Rounded up without ceil(), which is a call where there is no SSE4.1.
  std::int64_t guess(double value) const {
    const double sample = to_samples(value);
    if (!(sample > 0)) return 0;
    if (!(sample < static_cast<double>(size_))) return size_;
    const auto below = static_cast<std::int64_t>(sample);
    return below + (static_cast<double>(below) < sample);
  }

  double origin_, spacing_, per_spacing_;
  std::int64_t size_;
};

}  // namespace standoff
