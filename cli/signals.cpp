#include "cli/signals.h"

#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstring>

#include "difi/error.h"
#include "difi/interrupt.h"

namespace difi::cli {
namespace {

std::atomic<bool> asked{false};
std::atomic<int> cancellable{0};
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free);

extern "C" void on_signal(int) {
  if (!asked.exchange(true) && cancellable > 0) return;
  remove_unfinished_files();
  static constexpr char kMessage[] = "difi: error: interrupted; no partial file was left, run it again\n";
  (void)!::write(STDERR_FILENO, kMessage, sizeof kMessage - 1);
  ::_exit(static_cast<int>(ErrorCode::interrupted));
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
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
}

Cancellable::Cancellable() { ++cancellable; }
Cancellable::~Cancellable() { --cancellable; }

bool interrupted() { return asked; }

}  // namespace difi::cli
