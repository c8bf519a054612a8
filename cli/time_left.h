// SPDX-License-Identifier: Apache-2.0
// How long work still takes, told only where it is known: the number that a bar shows never climbs.
#pragma once

#include <deque>
#include <optional>
#include <string>

namespace standoff::cli {

class TimeLeft {
 public:
  /// Takes the finished share of the work, so many seconds after its beginning; neither ever decreases. Returns the
  /// seconds that are left, never more than before; nothing where the work goes too unevenly to tell, has only just
  /// begun, or has become slower than what was told.
  std::optional<double> at(double seconds, double fraction);

 private:
  struct Sample {
    double seconds, fraction;
  };
  std::deque<Sample> samples_;  // of the last half of the time, and the one before
  std::optional<double> told_;  // the least that was
};

/// "8 s left", "less than 1 s left", "3 min left": as coarse as the estimate is.
std::string time_left_text(double seconds);

}  // namespace standoff::cli
