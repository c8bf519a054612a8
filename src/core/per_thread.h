// SPDX-License-Identifier: Apache-2.0
// What each thread of parallel work has to itself, and what it keeps between calls.
#pragma once

#include <tbb/task_arena.h>

#include <algorithm>
#include <cstddef>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

namespace standoff {

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

}  // namespace standoff
