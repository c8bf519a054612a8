// What a terminal shows while files are read and written: the longest silences of all.
#pragma once

#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

#include "cli/talk.h"

namespace standoff::cli {

/// While one lives, a terminal shows what is waited for and for how long, once that is longer than a moment. Elsewhere,
/// and where the user wants no progress shown, it does nothing.
class Waiting {
 public:
  /// `what` is short: "reading bunny.obj".
  Waiting(const Talk& talk, const std::string& what);
  Waiting(const Waiting&) = delete;
  Waiting& operator=(const Waiting&) = delete;
  ~Waiting();

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
auto waiting(const Talk& talk, const std::string& what, Work work) {
  const Waiting shown(talk, what);
  return work();
}

}  // namespace standoff::cli
