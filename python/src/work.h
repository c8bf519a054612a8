// SPDX-License-Identifier: Apache-2.0
// Runs the library's work for Python: without the interpreter's lock, stopped by Ctrl-C, with progress.
#pragma once

#include <functional>
#include <mutex>
#include <utility>

#include "common.h"
#include "standoff/progress.h"

namespace standoff::python {

/// Runs `work` on another thread, and waits for it without the interpreter's lock. Meanwhile this thread, which is
/// the only one that can, lets Python handle signals every 20 ms and calls `progress(stage, fraction)`, unless that is
/// None. An exception of either cancels the work through the callback that `work` gets, and is thrown here.
void run_watched(const nb::object& progress, const std::function<void(const ProgressCallback&)>& work);

/// The same with a result.
template <class Work>
auto watched(const nb::object& progress, Work&& work) {
  std::optional<decltype(work(std::declval<const ProgressCallback&>()))> result;
  run_watched(progress, [&](const ProgressCallback& report) { result.emplace(work(report)); });
  return std::move(*result);
}

/// Watched calls of one object, one at a time: others wait, without the interpreter's lock.
class CallsInTurn {
 public:
  /// Reports to the call that is at work. For what lives as long as this.
  ProgressCallback callback() {
    return [this](const Progress& now) { return !report_ || report_(now); };
  }

  void run(const nb::object& progress, const std::function<void()>& call);

 private:
  std::mutex calling_;
  ProgressCallback report_;  // of the call at work
};

/// Work on `count` items in parts, so that it can be stopped between them: parts grow until one takes about 20 ms.
/// `part(first, last)` does the items from first to last.
void run_in_parts(const nb::object& progress, std::size_t count, std::size_t first_part,
                  const std::function<void(std::size_t, std::size_t)>& part);

}  // namespace standoff::python
