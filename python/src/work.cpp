// SPDX-License-Identifier: Apache-2.0
#include "work.h"

#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "lock.h"
#include "standoff/error.h"

namespace standoff::python {
namespace {

constexpr std::chrono::milliseconds kPoll{20};

// A thread that does one piece of work after the other. It is kept, because TBB keeps some KB of each thread that it
// has seen: with a new thread for each call memory would grow.
class Worker {
 public:
  Worker() {
    std::thread([this] { serve(); }).detach();  // it waits until the process ends, or end() is called
  }

  void start(std::function<void()> work) {
    const std::lock_guard lock(mutex_);
    work_ = std::move(work);
    changed_.notify_one();
  }
  /// After its work: the thread deletes this.
  void end() { start(nullptr); }

 private:
  void serve() {
    for (;;) {
      std::unique_lock lock(mutex_);
      // Not wait(), which asks for a newer libstdc++ than all else does (docs/python_packaging.md).
      while (!changed_.wait_for(lock, std::chrono::hours(1), [&] { return work_.has_value(); })) {
      }
      const std::function<void()> work = std::move(*work_);
      work_.reset();
      lock.unlock();
      if (!work) return delete this;
      work();
    }
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<std::function<void()>> work_;
};

// The workers of this process that are idle. A process that was forked has none: it forgets its parent's.
class Workers {
 public:
  static Workers& of_process() {
    static std::atomic<Workers*> current{new Workers};
    Workers* mine = current;
    while (mine->process_ != ::getpid())
      if (current.compare_exchange_strong(mine, new Workers)) mine = current;
    return *mine;
  }

  Worker* take() {
    const std::lock_guard lock(mutex_);
    if (idle_.empty()) return new Worker;
    Worker* const worker = idle_.back();
    idle_.pop_back();
    return worker;
  }
  void give_back(Worker* worker) {
    constexpr std::size_t kMostIdle = 16;
    const std::lock_guard lock(mutex_);
    if (idle_.size() < kMostIdle)
      idle_.push_back(worker);
    else
      worker->end();
  }

 private:
  const ::pid_t process_ = ::getpid();
  std::mutex mutex_;
  std::vector<Worker*> idle_;
};

// What the working thread and the watching one share.
struct Shared {
  std::mutex mutex;
  std::condition_variable changed;
  Progress seen{"preparing the mesh", 0};
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
    Workers& workers = Workers::of_process();
    Worker* const worker = workers.take();
    worker->start([&] {
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
    workers.give_back(worker);
  }
  if (ours) std::rethrow_exception(ours);
  if (shared.error) std::rethrow_exception(shared.error);
  report_to(progress, {"done", 1});
}

void CallsInTurn::run(const nb::object& progress, const std::function<void()>& call) {
  run_watched(progress, [&](const ProgressCallback& report) {
    const std::lock_guard one_call(calling_);
    report_ = report;
    try {
      call();
    } catch (...) {
      report_ = nullptr;
      throw;
    }
    report_ = nullptr;
  });
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
