// SPDX-License-Identifier: Apache-2.0
// Parallel work: the threads of a call, data of each thread, and the middle step of a parallel counting sort.
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

/// The number of threads asked for; if it is 0, the number that the caller may use.
inline int thread_count(int asked) { return asked > 0 ? asked : std::max(1, tbb::this_task_arena::max_concurrency()); }

/// A TBB arena for a call, reused from earlier calls. TBB frees an arena long after its last use, so a new one for each
/// call would let memory grow. It takes no lock, so a forked process may go on.
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

/// Runs work on thread_count(asked) threads. TBB by itself takes at most one thread per core, and warns on stderr.
class Threads {
 public:
  explicit Threads(int asked) : count_(thread_count(asked)) {
    constexpr auto kMost = tbb::global_control::max_allowed_parallelism;
    if (static_cast<std::size_t>(count_) > tbb::global_control::active_value(kMost))
      more_.emplace(kMost, static_cast<std::size_t>(count_));
  }

  int count() const { return count_; }

  /// While the calling thread waits, it takes up no task from outside of the work. If the caller is a task and is
  /// cancelled, the work is not: it would look as if it were done.
  template <class Work>
  auto run(const Work& work) {
    // Outside of tasks, nothing can cancel the work in the thread's own arena.
    if (!tbb::task::current_context() && tbb::this_task_arena::max_concurrency() == count_)
      return tbb::this_task_arena::isolate(work);
    const BorrowedArena arena(count_);
    return (*arena).execute(work);
  }

 private:
  int count_;
  std::optional<tbb::global_control> more_;
};

/// A T for each slot of the TBB arena of the thread that makes this, made when the slot is first used. Unlike
/// tbb::enumerable_thread_specific, which has one for every thread that ever uses it, it never has more than the arena
/// has slots: so its memory is known beforehand. An arena has at least two slots.
template <class T>
class PerThread {
 public:
  explicit PerThread(std::function<T()> make = [] { return T(); })
      : make_(std::move(make)), all_(static_cast<std::size_t>(std::max(2, tbb::this_task_arena::max_concurrency()))) {}

  /// The T of the calling thread, which must be in that arena.
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

/// A T that the calling thread keeps from one use to the next, so that calls need not allocate its memory again. Until
/// this is destroyed, the T is not shared: if the thread makes a second KeptByThread<T> meanwhile, as a callback may,
/// it gets a new T.
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

/// The middle step of a counting sort. `counts` holds, for each part of the input, the number of items of each of
/// `keys` keys. Replaces each count by the place of its first item in the output, which is sorted by key, then by part.
/// Calls begins(key, place) for each key in order, and returns the number of items.
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
