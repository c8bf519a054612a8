// SPDX-License-Identifier: Apache-2.0
// Worker processes: they take tasks one after the other, and whatever happens to one of them costs its task alone.
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace standoff::cli {

struct PoolTask {
  std::int64_t number = 0;
  std::string text;    ///< what the worker gets
  bool alone = false;  ///< to begin when no other task runs, and no other begins meanwhile
};

struct TaskEnd {
  enum class Kind {
    answered,   ///< `answer` is what the work returned
    died,       ///< its process ended, as `status` says
    timed_out,  ///< its process was ended, because it took too long
  };
  Kind kind = Kind::answered;
  std::string answer = {};
  int status = 0;      ///< as waitpid() has it
  double seconds = 0;  ///< that it ran, but for waiting to be alone
};

/// Does a task in a worker process and returns the answer. It may call the function once it knows that it needs the
/// whole machine: that returns when no other task runs. It must throw nothing.
using PoolWork = std::function<std::string(const std::string& task, const std::function<void()>& wait_to_be_alone)>;

/// Processes are forked from this one when they are first needed, so what the work refers to is copied then; whoever
/// makes a pool must have started no thread.
class WorkerPool {
 public:
  /// `timeout_s`: how long a task may take; infinite for no limit.
  WorkerPool(int workers, double timeout_s, PoolWork work);
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;
  /// Ends the workers, those with a task too.
  ~WorkerPool();

  /// Workers close this open file: what is locked by it is locked no longer than this process lives. Call it before
  /// run().
  void keep_from_workers(int descriptor) { own_ = descriptor; }

  enum class Next {
    task,
    not_yet,
    later,  ///< one that must wait for a task that was given before: next() is asked again when one has ended
    end,
  };
  struct Caller {
    std::function<Next(PoolTask&)> next;                      ///< sets the next task
    std::function<void(std::int64_t number, TaskEnd)> ended;  ///< called once for each task
    std::function<void()> tick;                               ///< called several times a second
    int descriptor = -1;  ///< readable when there is more after not_yet; -1: next() is asked again at once
  };
  /// Does all tasks. Errors: interrupted, soon after a signal (cli/process.h), without a word about tasks that ran;
  /// limit, where no process can be started; what the caller's functions throw.
  void run(const Caller& caller);

 private:
  // A worker has its next task before it has done one, so that it need not wait for the pool's answer to its own.
  static constexpr std::size_t kAhead = 2;

  using Clock = std::chrono::steady_clock;
  struct Worker {
    enum class State { idle, working, waiting };  // waiting to be alone
    State state = State::idle;
    pid_t process = -1;
    int socket = -1;
    std::deque<PoolTask> tasks;  // the first is being done
    double seconds = 0;          // that it has run before `since`
    Clock::time_point since{};
    std::string received;  // of an answer

    bool runs() const { return process >= 0; }
  };

  void start(Worker& worker);
  void feed(const Caller& caller);
  std::optional<PoolTask> next_task(const Caller& caller);
  Worker* worker_with_room();
  void give(Worker& worker, PoolTask task);
  void begin_next(Worker& worker);
  void grant();
  void wait_for_something(const Caller& caller);
  void receive(Worker& worker, const Caller& caller);
  void take_messages(Worker& worker, const Caller& caller);
  void end_late_ones(const Caller& caller);
  TaskEnd bury(Worker& worker, TaskEnd::Kind kind);
  void end(Worker& worker, int first_signal);
  double seconds_of(const Worker& worker) const;
  bool any(Worker::State state) const;

  double timeout_s_;
  PoolWork work_;
  int own_ = -1;
  std::vector<Worker> workers_;
  std::deque<PoolTask> held_;  // to be given before others: what waits to begin alone, or stood behind a lost task
  bool one_is_alone_ = false;
  bool ended_ = false;    // there are no more tasks
  bool not_yet_ = false;  // there may be
};

}  // namespace standoff::cli
