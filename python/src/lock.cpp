// SPDX-License-Identifier: Apache-2.0
#include "lock.h"

#include <pthread.h>

#include <atomic>

#include "standoff/error.h"

namespace standoff::python {
namespace {

std::atomic<int> working{0};
std::atomic<bool> torn{false};

}  // namespace

void begin_work() {
  static const int registered = pthread_atfork(nullptr, nullptr, [] {
    if (working > 0) torn = true;
  });
  static_cast<void>(registered);
  if (torn)
    throw Error(ErrorCode::usage,
                "this process was forked while another thread computed, so it waits for threads that it does not have; "
                "start workers by multiprocessing's method 'spawn' or 'forkserver', or before anything is computed");
  ++working;
}

void end_work() noexcept { --working; }

}  // namespace standoff::python
