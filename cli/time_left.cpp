// SPDX-License-Identifier: Apache-2.0
#include "cli/time_left.h"

#include <algorithm>
#include <cmath>

namespace standoff::cli {

// The speed is that of the last half of the time, so that a slow or quick beginning is forgotten, and counts only where
// it is about the speed of the whole: work of even steps is told of, that of stages of different speeds is not.
std::optional<double> TimeLeft::at(double seconds, double fraction) {
  constexpr double kFirstSeconds = 0.5, kFirstFraction = 0.05;
  constexpr double kLargestRatio = 1.6;  // of the two speeds; at a ratio of 2 estimates are half, or double
  constexpr double kSlack = 1.3;         // an estimate that grew by so much or less is kept as it was told
  samples_.push_back({seconds, fraction});
  while (samples_.size() > 2 && samples_[1].seconds <= seconds / 2) samples_.pop_front();
  const Sample& then = samples_.front();
  if (seconds < kFirstSeconds || fraction < kFirstFraction || then.seconds >= seconds) return std::nullopt;
  const double whole_speed = fraction / seconds;
  const double speed = (fraction - then.fraction) / (seconds - then.seconds);
  if (speed > kLargestRatio * whole_speed || whole_speed > kLargestRatio * speed) return std::nullopt;
  const double left = (1 - fraction) / speed;
  if (told_ && left > kSlack * *told_) return std::nullopt;
  told_ = std::min(left, told_.value_or(left));
  return told_;
}

std::string time_left_text(double seconds) {
  if (seconds < 1) return "less than 1 s left";
  if (seconds < 90) return std::to_string(std::lround(seconds)) + " s left";
  if (seconds < 5400) return std::to_string(std::lround(seconds / 60)) + " min left";
  return std::to_string(std::lround(seconds / 3600)) + " h left";
}

}  // namespace standoff::cli
