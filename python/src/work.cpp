// SPDX-License-Identifier: Apache-2.0
#include "work.h"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>

#include "lock.h"
#include "standoff/error.h"

namespace standoff::python {
namespace {

constexpr std::chrono::milliseconds kPoll{20};

// What the working thread and the watching one share.
struct Shared {
  std::mutex mutex;
  std::condition_variable changed;
  Progress seen{"prepare", 0};
  bool stopped = false;   // the watching thread wants the work to end
  bool finished = false;  // the work has ended
  std::exception_ptr error;
};

void report_to(const nb::object& progress, const Progress& seen) {
  if (progress.is_none()) return;
  const nb::str stage(seen.stage);
  const nb::float_ fraction(seen.fraction);
  const nb::object answer = nb::steal(
      ask_python([&] { return PyObject_CallFunctionObjArgs(progress.ptr(), stage.ptr(), fraction.ptr(), nullptr); }));
  if (!answer.is_valid()) throw nb::python_error();
}

// Signals, then progress. Called with the lock of the interpreter.
void poll(const nb::object& progress, const Progress& seen) {
  if (ask_python([] { return PyErr_CheckSignals(); }) != 0) throw nb::python_error();
  report_to(progress, seen);
}

}  // namespace

void run_watched(const nb::object& progress, const std::function<void(const ProgressCallback&)>& work) {
  Shared shared;
  const ProgressCallback callback = [&shared](const Progress& now) {
    const std::lock_guard lock(shared.mutex);
    shared.seen = now;
    return !shared.stopped;
  };
  std::exception_ptr ours;
  {
    const Unlocked released;
    std::thread worker([&] {
      std::exception_ptr error;
      try {
        work(callback);
      } catch (...) {
        error = std::current_exception();
      }
      const std::lock_guard lock(shared.mutex);
      shared.error = error;
      shared.finished = true;
      shared.changed.notify_one();
    });
    std::unique_lock lock(shared.mutex);
    while (!shared.changed.wait_for(lock, kPoll, [&] { return shared.finished; })) {
      if (ours) continue;  // the work is on its way out
      const Progress seen = shared.seen;
      lock.unlock();
      try {
        const Locked held;
        poll(progress, seen);
      } catch (...) {
        ours = std::current_exception();
      }
      lock.lock();
      shared.stopped = ours != nullptr;
    }
    lock.unlock();
    worker.join();
  }
  if (ours) std::rethrow_exception(ours);
  if (shared.error) std::rethrow_exception(shared.error);
  report_to(progress, {"done", 1});
}

void run_in_parts(const nb::object& progress, std::size_t count, std::size_t first_part,
                  const std::function<void(std::size_t, std::size_t)>& part) {
  run_watched(progress, [&](const ProgressCallback& report) {
    std::size_t size = std::max<std::size_t>(first_part, 1);
    for (std::size_t first = 0; first < count;) {
      const auto began = std::chrono::steady_clock::now();
      const std::size_t last = first + std::min(size, count - first);
      part(first, last);
      if (!report({"queries", static_cast<double>(last) / static_cast<double>(count)}))
        throw Error(ErrorCode::interrupted, "interrupted");
      if (std::chrono::steady_clock::now() - began < kPoll) size *= 2;
      first = last;
    }
  });
}

}  // namespace standoff::python
