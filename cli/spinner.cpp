// SPDX-License-Identifier: Apache-2.0
#include "cli/spinner.h"

#include <chrono>
#include <cstdio>
#include <system_error>

#include "cli/signals.h"
#include "cli/text.h"

namespace standoff::cli {

Spinner::Spinner(const Console& console, const std::string& what) : what_(one_line(what)) {
  if (!console.shows_progress()) return;
  try {
    thread_ = std::thread([this] { show(); });
  } catch (const std::system_error&) {
    // No thread to be had: then the terminal stays silent.
  }
}

Spinner::~Spinner() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    over_ = true;
  }
  ended_.notify_one();
  thread_.join();
}

void Spinner::show() {
  using namespace std::chrono_literals;
  const auto start = std::chrono::steady_clock::now();
  std::unique_lock lock(mutex_);
  if (ended_.wait_for(lock, 300ms, [this] { return over_; })) return;
  line_is_drawn(true);
  do {
    const double elapsed = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    std::fprintf(stderr, "\r\033[K%s, %s", what_.c_str(), seconds_text(elapsed).c_str());
    std::fflush(stderr);
  } while (!ended_.wait_for(lock, 100ms, [this] { return over_; }));
  std::fputs("\r\033[K", stderr);
  line_is_drawn(false);
}

}  // namespace standoff::cli
