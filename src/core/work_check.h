// SPDX-License-Identifier: Apache-2.0
// Lets the caller stop work that has no steps of its own to report.
#pragma once

#include <cstdint>

#include "core/progress.h"

namespace standoff {

/// Of one thread: counts its work, and checks the progress now and then.
class WorkCheck {
 public:
  /// Checks after so much work, in whatever unit: some ten milliseconds of it at the most.
  WorkCheck(ProgressMeter& progress, std::int64_t often) : progress_(&progress), often_(often), left_(often) {}

  /// Throws as ProgressMeter::check() does.
  void add(std::int64_t work) {
    left_ -= work;
    if (left_ > 0) return;
    left_ = often_;
    progress_->check();
  }

 private:
  ProgressMeter* progress_;
  std::int64_t often_, left_;
};

}  // namespace standoff
