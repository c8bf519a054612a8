// SPDX-License-Identifier: Apache-2.0
// What a terminal shows while files are read and written: the longest silences of all.
#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>
#include <type_traits>

#include "cli/console.h"
#include "cli/text.h"

namespace standoff::cli {

/// While one lives, a terminal shows what is waited for and for how long, once that is longer than a moment. Elsewhere,
/// and where the user wants no progress shown, it does nothing.
class Spinner {
 public:
  /// `what` is short: "reading bunny.obj".
  Spinner(const Console& console, const std::string& what);
  Spinner(const Spinner&) = delete;
  Spinner& operator=(const Spinner&) = delete;
  ~Spinner();

 private:
  void show();

  std::string what_;
  std::mutex mutex_;
  std::condition_variable ended_;
  bool over_ = false;
  std::thread thread_;
};

/// The result of `work`, shown as waited for meanwhile. With --verbose it is said how long it took.
template <class Work>
auto with_spinner(const Console& console, const std::string& what, Work work) {
  const auto start = std::chrono::steady_clock::now();
  const auto tell = [&] {
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
    console.detail(what + ": " + seconds_text(elapsed.count()));
  };
  const auto shown_work = [&] {
    const Spinner shown(console, what);
    return work();
  };
  if constexpr (std::is_void_v<decltype(work())>) {
    shown_work();
    tell();
  } else {
    auto result = shown_work();
    tell();
    return result;
  }
}

}  // namespace standoff::cli
