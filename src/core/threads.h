// SPDX-License-Identifier: Apache-2.0
// The threads that a call takes.
#pragma once

#include <tbb/global_control.h>
#include <tbb/task.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cstddef>
#include <optional>

namespace standoff {

/// As many as asked for; where that is 0, as many as the caller may use.
inline int thread_count(int asked) { return asked > 0 ? asked : std::max(1, tbb::this_task_arena::max_concurrency()); }

/// A TBB arena of its own for a call, out of those that calls before it have left. TBB frees an arena long after its
/// last use: one for each call would let memory grow. No lock is taken, so a process that was forked may go on.
class BorrowedArena {
 public:
  explicit BorrowedArena(int threads);
  ~BorrowedArena();
  BorrowedArena(const BorrowedArena&) = delete;
  BorrowedArena& operator=(const BorrowedArena&) = delete;

  tbb::task_arena& operator*() const { return *arena_; }

 private:
  tbb::task_arena* arena_;
};

/// Runs work on thread_count(asked) threads. TBB by itself takes no more than there are cores, and says so on stderr.
class Threads {
 public:
  explicit Threads(int asked) : count_(thread_count(asked)) {
    constexpr auto kMost = tbb::global_control::max_allowed_parallelism;
    if (static_cast<std::size_t>(count_) > tbb::global_control::active_value(kMost))
      more_.emplace(kMost, static_cast<std::size_t>(count_));
  }

  int count() const { return count_; }

  /// The calling thread, while it waits, takes up no task from outside of the work; and what cancels a task from which
  /// it was called does not cancel the work, which would look as if it was done.
  template <class Work>
  auto run(const Work& work) {
    // Outside of tasks, the arena that the thread is in has nothing to cancel.
    if (!tbb::task::current_context() && tbb::this_task_arena::max_concurrency() == count_)
      return tbb::this_task_arena::isolate(work);
    const BorrowedArena arena(count_);
    return (*arena).execute(work);
  }

 private:
  int count_;
  std::optional<tbb::global_control> more_;
};

}  // namespace standoff
