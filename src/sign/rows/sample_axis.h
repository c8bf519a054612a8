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
    return first_from_guess(sample_at_or_above(to_samples(value), size_), size_, is_true);
  }
  /// The first sample at or above `value`, or the number of samples.
  std::int64_t first_from(double value) const {
    return first(value, [&](std::int64_t n) { return at(n) >= value; });
  }

 private:
  double origin_, spacing_, per_spacing_;
  std::int64_t size_;
};

}  // namespace standoff
