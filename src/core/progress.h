// SPDX-License-Identifier: Apache-2.0
// The progress of long work: many threads count it, one at a time reports it to the caller.
#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>

#include "core/guarded.h"
#include "standoff/error.h"
#include "standoff/progress.h"

namespace standoff {

class ProgressMeter {
 public:
  /// For work that nobody watches.
  ProgressMeter() : ProgressMeter(nobody()) {}
  /// `callback` may be empty, and must outlive the meter.
  explicit ProgressMeter(const ProgressCallback& callback) : callback_(callback) {}

  /// Whether anybody watches.
  bool is_watched() const { return static_cast<bool>(callback_); }

  /// Begins a stage of `units` steps that spans [from, to] of the whole. Called between parallel parts.
  void stage(const char* name, std::int64_t units, double from, double to) {
    stage_ = {name, from};
    units_ = units > 0 ? units : 1;
    span_ = to - from;
    done_ = 0;
    tell();
  }

  /// Lets the caller stop work in the middle of a step, from any thread. Throws Error{interrupted}.
  void check() { advance(0); }

  /// Counts finished steps, from any thread. Throws Error{interrupted} once the caller has asked to stop.
  void advance(std::int64_t units = 1) {
    if (!callback_) return;
    done_.fetch_add(units, std::memory_order_relaxed);
    tell();
  }

 private:
  void tell() {
    if (!callback_) return;
    if (std::unique_lock lock(calling_, std::try_to_lock); lock && !cancelled_) {
      const double share = static_cast<double>(done_.load(std::memory_order_relaxed)) / static_cast<double>(units_);
      const Progress now{stage_.stage, stage_.fraction + span_ * (share < 1 ? share : 1)};
      if (!call_back(callback_, now)) cancelled_ = true;
    }
    if (cancelled_) throw Error(ErrorCode::interrupted, "compute: cancelled; nothing was kept");
  }

  static const ProgressCallback& nobody() {
    static const ProgressCallback none;
    return none;
  }

  const ProgressCallback& callback_;
  Progress stage_;
  std::int64_t units_ = 1;
  double span_ = 0;
  std::atomic<std::int64_t> done_{0};
  std::atomic<bool> cancelled_{false};
  std::mutex calling_;
};

/// Counts the work of one thread, and checks the progress now and then.
class WorkCheck {
 public:
  /// Checks the progress after `often` units of work, which should take at most some ten milliseconds.
  WorkCheck(ProgressMeter& progress, std::int64_t often) : progress_(&progress), often_(often), left_(often) {}

  /// Throws Error{interrupted}.
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
