// SPDX-License-Identifier: Apache-2.0
// Whether somebody still looks at the page.
#pragma once

#include <chrono>
#include <mutex>

namespace standoff::view {

/// A page keeps a stream open for as long as it is shown. While it is loaded again there is none for a moment.
class PageWatch {
 public:
  using Clock = std::chrono::steady_clock;

  /// While one lives, a page is open.
  class Open {
   public:
    explicit Open(PageWatch& watch) : watch_(watch) { watch_.count(1); }
    Open(const Open&) = delete;
    Open& operator=(const Open&) = delete;
    ~Open() { watch_.count(-1); }

   private:
    PageWatch& watch_;
  };

  /// Whether a page was open, and none has been for `grace`.
  bool closed_for(std::chrono::milliseconds grace) const {
    const std::lock_guard lock(mutex_);
    return seen_ && open_ == 0 && Clock::now() - last_ >= grace;
  }
  bool seen() const {
    const std::lock_guard lock(mutex_);
    return seen_;
  }

 private:
  void count(int change) {
    const std::lock_guard lock(mutex_);
    open_ += change;
    seen_ = true;
    last_ = Clock::now();
  }

  mutable std::mutex mutex_;
  int open_ = 0;
  bool seen_ = false;
  Clock::time_point last_;
};

}  // namespace standoff::view
