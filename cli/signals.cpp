// SPDX-License-Identifier: Apache-2.0
#include "cli/signals.h"

#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstring>

#include "files/temp_file_registry.h"
#include "standoff/error.h"

namespace standoff::cli {
namespace {

std::atomic<bool> asked{false};
std::atomic<int> cancellable{0};
std::atomic<bool> line_drawn{false};
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free);

template <std::size_t size>
[[noreturn]] void end(const char (&message)[size], ErrorCode code) {
  static constexpr char kWipe[] = "\r\033[K";
  remove_unfinished_files();
  if (line_drawn) (void)!::write(STDERR_FILENO, kWipe, sizeof kWipe - 1);
  (void)!::write(STDERR_FILENO, message, size - 1);
  ::_exit(static_cast<int>(code));
}

extern "C" void on_signal(int) {
  if (!asked.exchange(true) && cancellable > 0) return;
  end("standoff: error: interrupted; no partial file was left, run it again\n", ErrorCode::interrupted);
}

// Field files are read from a mapping; what was there a moment ago is gone.
extern "C" void on_lost_file(int) {
  end("standoff: error: a file that was being read became shorter or its disk failed; see who writes to it, run it "
      "again\n",
      ErrorCode::input);
}

}  // namespace

void install_signal_handlers() {
  struct sigaction action {};
  action.sa_handler = on_signal;
  sigemptyset(&action.sa_mask);
  action.sa_flags = SA_RESTART;
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction before {};
    ::sigaction(signal, nullptr, &before);
    if (before.sa_handler != SIG_IGN) ::sigaction(signal, &action, nullptr);
  }
  std::signal(SIGBUS, on_lost_file);
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
}

Cancellable::Cancellable() { ++cancellable; }
Cancellable::~Cancellable() { --cancellable; }

bool interrupted() { return asked; }

void line_is_drawn(bool drawn) { line_drawn = drawn; }

}  // namespace standoff::cli
