// What a terminal shows while files are read and written: the longest silences of all.
#pragma once

#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

#include "cli/console.h"

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

/// The result of `work`, shown as waited for meanwhile.
template <class Work>
auto with_spinner(const Console& console, const std::string& what, Work work) {
  const Spinner shown(console, what);
  return work();
}

}  // namespace standoff::cli
