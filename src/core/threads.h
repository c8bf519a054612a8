// SPDX-License-Identifier: Apache-2.0
// Parallel work: the threads that a call takes, what each of them has to itself, and the middle of a parallel counting
// sort.
#pragma once

#include <tbb/global_control.h>
#include <tbb/task.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

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

/// One T for each slot of the TBB arena of the thread that makes this, made when the slot is first used. Unlike
/// tbb::enumerable_thread_specific, which has one for every thread that ever comes by, there are never more than the
/// arena has slots: so its memory is known beforehand. An arena has at least two slots.
template <class T>
class PerThread {
 public:
  explicit PerThread(std::function<T()> make = [] { return T(); })
      : make_(std::move(make)), all_(static_cast<std::size_t>(std::max(2, tbb::this_task_arena::max_concurrency()))) {}

  /// The calling thread's, which is in that arena.
  T& local() {
    std::unique_ptr<T>& mine = all_.at(static_cast<std::size_t>(tbb::this_task_arena::current_thread_index()));
    if (!mine) mine = std::make_unique<T>(make_());
    return *mine;
  }

  template <class Use>
  void for_each(const Use& use) const {
    for (const auto& one : all_)
      if (one) use(*one);
  }

 private:
  std::function<T()> make_;
  std::vector<std::unique_ptr<T>> all_;
};

/// A T that the calling thread keeps from one use to the next, for memory that would otherwise be taken and given back
/// by each call. Who uses it has it alone, until this is destroyed: where the thread uses another one in between, as a
/// callback may, that is a new one.
template <class T>
class KeptByThread {
 public:
  KeptByThread() : mine_(std::move(kept())) {
    if (!mine_) mine_ = std::make_unique<T>();
  }
  ~KeptByThread() { kept() = std::move(mine_); }
  KeptByThread(const KeptByThread&) = delete;
  KeptByThread& operator=(const KeptByThread&) = delete;

  T& operator*() const { return *mine_; }
  T* operator->() const { return mine_.get(); }

 private:
  static std::unique_ptr<T>& kept() {
    thread_local std::unique_ptr<T> one;
    return one;
  }

  std::unique_ptr<T> mine_;
};

/// `counts` holds, for each part of the input, how many of its items belong to each of `keys` keys. Each count becomes
/// the place of its first item in the sorted output: by key, then by part. Calls begins(key, place) for each key in
/// order, and returns the number of items.
template <class Parts, class Begins>
auto places_from_counts(Parts& counts, std::size_t keys, const Begins& begins) {
  auto total = typename Parts::value_type::value_type{0};
  for (std::size_t key = 0; key < keys; ++key) {
    begins(key, total);
    for (auto& count : counts) total += std::exchange(count[key], total);
  }
  return total;
}

}  // namespace standoff
