// SPDX-License-Identifier: Apache-2.0
// What each thread of parallel work has to itself.
#pragma once

#include <tbb/task_arena.h>

#include <cstddef>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

namespace standoff {

/// One T for each slot of the TBB arena of the thread that makes this, made when the slot is first used. Unlike
/// tbb::enumerable_thread_specific, which has one for every thread that ever comes by, there are never more than the
/// arena has slots: so its memory is known beforehand.
template <class T>
class PerThread {
 public:
  explicit PerThread(std::function<T()> make = [] { return T(); })
      : make_(std::move(make)), all_(static_cast<std::size_t>(tbb::this_task_arena::max_concurrency())) {}

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

}  // namespace standoff
