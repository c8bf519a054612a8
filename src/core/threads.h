// SPDX-License-Identifier: Apache-2.0
// The threads that a call takes.
#pragma once

#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cstddef>
#include <optional>

namespace standoff {

/// As many as asked for; where that is 0, as many as the caller may use.
inline int thread_count(int asked) { return asked > 0 ? asked : std::max(1, tbb::this_task_arena::max_concurrency()); }

/// Runs work on thread_count(asked) threads. TBB by itself takes no more than there are cores, and says so on stderr.
class Threads {
 public:
  explicit Threads(int asked) : count_(thread_count(asked)), arena_(count_) {
    constexpr auto kMost = tbb::global_control::max_allowed_parallelism;
    if (static_cast<std::size_t>(count_) > tbb::global_control::active_value(kMost))
      more_.emplace(kMost, static_cast<std::size_t>(count_));
  }

  int count() const { return count_; }
  template <class Work>
  auto run(const Work& work) {
    return arena_.execute(work);
  }

 private:
  int count_;
  std::optional<tbb::global_control> more_;
  tbb::task_arena arena_;
};

}  // namespace standoff
