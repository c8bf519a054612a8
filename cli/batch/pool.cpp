// SPDX-License-Identifier: Apache-2.0
#include "cli/batch/pool.h"

#include <poll.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>
#ifdef __linux__
#include <sys/prctl.h>
#endif

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstring>
#include <thread>
#include <utility>

#include "cli/process.h"
#include "files/atomic_file.h"
#include "standoff/error.h"

namespace standoff::cli {
namespace {

// Messages: a letter, the length of the text in 8 bytes, the text.
constexpr char kTask = 't', kAnswer = 'a', kAskToBeAlone = 'l', kYouAreAlone = 'y';
constexpr std::size_t kHead = 9;

bool send_all(int socket, const char* data, std::size_t bytes) {
  while (bytes > 0) {
    const auto sent = ::write(socket, data, bytes);
    if (sent < 0 && errno == EINTR) continue;
    if (sent <= 0) return false;
    data += sent;
    bytes -= static_cast<std::size_t>(sent);
  }
  return true;
}

bool send_message(int socket, char kind, const std::string& text) {
  std::string message(kHead, kind);
  const std::uint64_t length = text.size();
  std::memcpy(message.data() + 1, &length, sizeof length);
  message += text;
  return send_all(socket, message.data(), message.size());
}

bool receive_all(int socket, char* data, std::size_t bytes) {
  while (bytes > 0) {
    const auto got = ::read(socket, data, bytes);
    if (got < 0 && errno == EINTR) continue;
    if (got <= 0) return false;
    data += got;
    bytes -= static_cast<std::size_t>(got);
  }
  return true;
}

// False when the other end is closed.
bool receive_message(int socket, char& kind, std::string& text) {
  char head[kHead];
  if (!receive_all(socket, head, sizeof head)) return false;
  kind = head[0];
  std::uint64_t length = 0;
  std::memcpy(&length, head + 1, sizeof length);
  text.resize(length);
  return receive_all(socket, text.data(), length);
}

// Its pool ends a worker by this. The terminal's interrupt goes to the workers too, who leave the answer to the pool.
extern "C" void on_worker_end(int signal) {
  remove_unfinished_files();
  std::signal(signal, SIG_DFL);
  ::kill(::getpid(), signal);
}

// What a worker runs. An exception must not unwind into the pool's functions, which this process has copies of: it ends
// the process.
[[noreturn]] void serve(int socket, const PoolWork& work) noexcept {
  std::signal(SIGINT, SIG_IGN);
  std::signal(SIGHUP, SIG_IGN);
  std::signal(SIGTERM, on_worker_end);
#ifdef __linux__
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);  // a pool that is killed says nothing
#endif
  std::deque<std::string> tasks;
  // Takes the next message; false when the pool has closed its end.
  const auto listen = [&](char& kind) {
    std::string text;
    if (!receive_message(socket, kind, text)) return false;
    if (kind == kTask) tasks.push_back(std::move(text));
    return true;
  };
  const auto wait_to_be_alone = [&] {
    char kind = kTask;
    if (!send_message(socket, kAskToBeAlone, "")) ::_exit(0);
    while (kind != kYouAreAlone)
      if (!listen(kind)) ::_exit(0);
  };
  for (;;) {
    char kind = 0;
    if (tasks.empty() && !listen(kind)) ::_exit(0);
    const std::string task = std::move(tasks.front());
    tasks.pop_front();
    if (!send_message(socket, kAnswer, work(task, wait_to_be_alone))) ::_exit(0);
  }
}

// Whether the process has ended, within the time.
bool has_ended(pid_t process, int& status, std::chrono::milliseconds within) {
  using namespace std::chrono_literals;
  for (auto waited = 0ms;; waited += 5ms) {
    const pid_t found = ::waitpid(process, &status, WNOHANG);
    if (found == process || (found < 0 && errno != EINTR)) return true;
    if (waited >= within) return false;
    std::this_thread::sleep_for(5ms);
  }
}

// Asks the process to end, then makes it. Returns its status.
int end_process(pid_t process, int first_signal) {
  using namespace std::chrono_literals;
  int status = 0;
  if (first_signal != 0) ::kill(process, first_signal);
  if (has_ended(process, status, 1s)) return status;
  ::kill(process, SIGKILL);
  while (::waitpid(process, &status, 0) < 0 && errno == EINTR) {
  }
  return status;
}

}  // namespace

WorkerPool::WorkerPool(int workers, double timeout_s, PoolWork work)
    : timeout_s_(timeout_s), work_(std::move(work)), workers_(static_cast<std::size_t>(workers)) {}

WorkerPool::~WorkerPool() {
  for (Worker& worker : workers_) {
    if (!worker.runs()) continue;
    ::close(worker.socket);  // an idle one ends by that
    if (worker.state != Worker::State::idle) ::kill(worker.process, SIGTERM);
  }
  for (Worker& worker : workers_)
    if (worker.runs()) end_process(worker.process, 0);
}

void WorkerPool::start(Worker& worker) {
  int ends[2];
  const auto fail = [] {
    throw Error(ErrorCode::limit, "batch: cannot start a process: " + std::string(std::strerror(errno)) +
                                      "; take fewer threads with -j, or raise the limit of processes");
  };
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) fail();
  const pid_t process = ::fork();
  if (process < 0) {
    ::close(ends[0]);
    ::close(ends[1]);
    fail();
  }
  if (process == 0) {
    // The others' ends: a worker notices the pool's end by the closing of its own.
    for (const Worker& other : workers_)
      if (other.socket >= 0) ::close(other.socket);
    ::close(ends[0]);
    if (own_ >= 0) ::close(own_);
    serve(ends[1], work_);
  }
  ::close(ends[1]);
  worker.process = process;
  worker.socket = ends[0];
}

bool WorkerPool::any(Worker::State state) const {
  return std::ranges::any_of(workers_, [&](const Worker& worker) { return worker.state == state; });
}

double WorkerPool::seconds_of(const Worker& worker) const {
  const bool runs = worker.state == Worker::State::working;
  return worker.seconds + (runs ? std::chrono::duration<double>(Clock::now() - worker.since).count() : 0);
}

void WorkerPool::run(const Caller& caller) {
  ended_ = not_yet_ = false;
  for (;;) {
    if (interrupted()) throw Error(ErrorCode::interrupted, "interrupted");
    feed(caller);
    const bool busy = any(Worker::State::working) || any(Worker::State::waiting);
    if (!busy && ended_ && held_.empty()) return;
    wait_for_something(caller);
    end_late_ones(caller);
    if (caller.tick) caller.tick();
  }
}

// Gives tasks to workers with room for them, unless one is alone or waits to be.
void WorkerPool::feed(const Caller& caller) {
  not_yet_ = false;
  while (!one_is_alone_ && !any(Worker::State::waiting)) {
    Worker* const worker = worker_with_room();
    if (!worker) break;
    std::optional<PoolTask> task = next_task(caller);
    if (!task) break;
    if (task->alone && any(Worker::State::working)) {
      held_.push_front(*std::move(task));
      break;
    }
    one_is_alone_ = task->alone;
    give(*worker, *std::move(task));
  }
  grant();
}

std::optional<PoolTask> WorkerPool::next_task(const Caller& caller) {
  PoolTask task;
  if (!held_.empty()) {
    task = std::move(held_.front());
    held_.pop_front();
    return task;
  }
  const Next next = ended_ ? Next::end : caller.next(task);
  ended_ = next == Next::end;
  not_yet_ = next == Next::not_yet;
  return next == Next::task ? std::optional(std::move(task)) : std::nullopt;
}

// The one with the fewest tasks.
WorkerPool::Worker* WorkerPool::worker_with_room() {
  const auto least = std::ranges::min_element(workers_, {}, [](const Worker& worker) { return worker.tasks.size(); });
  return least->tasks.size() < kAhead ? &*least : nullptr;
}

void WorkerPool::give(Worker& worker, PoolTask task) {
  if (!worker.runs()) start(worker);
  if (!send_message(worker.socket, kTask, task.text) && worker.tasks.empty()) {
    bury(worker, TaskEnd::Kind::died);  // somebody has ended it while it was idle
    start(worker);
    send_message(worker.socket, kTask, task.text);
  }
  worker.tasks.push_back(std::move(task));
  if (worker.state == Worker::State::idle) begin_next(worker);
}

void WorkerPool::begin_next(Worker& worker) {
  worker.state = worker.tasks.empty() ? Worker::State::idle : Worker::State::working;
  worker.seconds = 0;
  worker.since = Clock::now();
}

// Lets one of those that wait go on, once nobody else works.
void WorkerPool::grant() {
  if (one_is_alone_ || any(Worker::State::working)) return;
  const auto next = std::ranges::find(workers_, Worker::State::waiting, &Worker::state);
  if (next == workers_.end()) return;
  one_is_alone_ = true;
  next->state = Worker::State::working;
  next->since = Clock::now();
  send_message(next->socket, kYouAreAlone, "");
}

void WorkerPool::wait_for_something(const Caller& caller) {
  double wait_s = 0.1;  // for the tick, and for a signal that came just before the poll
  std::vector<pollfd> ready;
  std::vector<Worker*> whose;
  for (Worker& worker : workers_) {
    if (worker.state == Worker::State::idle) continue;
    if (worker.state == Worker::State::working) wait_s = std::min(wait_s, timeout_s_ - seconds_of(worker));
    ready.push_back({worker.socket, POLLIN, 0});
    whose.push_back(&worker);
  }
  if (not_yet_ && caller.descriptor >= 0) ready.push_back({caller.descriptor, POLLIN, 0});
  if (not_yet_ && caller.descriptor < 0) wait_s = 0;
  const int wait_ms = static_cast<int>(std::ceil(std::max(0.0, wait_s) * 1000));
  if (::poll(ready.data(), ready.size(), wait_ms) <= 0) return;
  for (std::size_t n = 0; n < whose.size(); ++n)
    if (ready[n].revents != 0) receive(*whose[n], caller);
}

void WorkerPool::receive(Worker& worker, const Caller& caller) {
  char buffer[1 << 16];
  const auto got = ::read(worker.socket, buffer, sizeof buffer);
  if (got < 0 && errno == EINTR) return;
  if (got <= 0) {
    const std::int64_t number = worker.tasks.front().number;
    return caller.ended(number, bury(worker, TaskEnd::Kind::died));
  }
  worker.received.append(buffer, static_cast<std::size_t>(got));
  take_messages(worker, caller);
}

void WorkerPool::take_messages(Worker& worker, const Caller& caller) {
  while (worker.received.size() >= kHead) {
    std::uint64_t length = 0;
    std::memcpy(&length, worker.received.data() + 1, sizeof length);
    if (worker.received.size() - kHead < length) return;
    const char kind = worker.received[0];
    std::string text = worker.received.substr(kHead, length);
    worker.received.erase(0, kHead + length);
    const double seconds = seconds_of(worker);
    if (kind == kAnswer) {
      const std::int64_t number = worker.tasks.front().number;
      worker.tasks.pop_front();
      one_is_alone_ = false;
      begin_next(worker);
      caller.ended(number, {.answer = std::move(text), .seconds = seconds});
    } else if (one_is_alone_) {  // it is
      send_message(worker.socket, kYouAreAlone, "");
    } else {
      worker.state = Worker::State::waiting;
      worker.seconds = seconds;
    }
  }
}

void WorkerPool::end_late_ones(const Caller& caller) {
  for (Worker& worker : workers_) {
    if (worker.state != Worker::State::working || seconds_of(worker) < timeout_s_) continue;
    const std::int64_t number = worker.tasks.front().number;
    caller.ended(number, bury(worker, TaskEnd::Kind::timed_out));
  }
}

// Sees to it that the process has ended. The next task starts a new one, and those that stood behind the lost one come
// first.
TaskEnd WorkerPool::bury(Worker& worker, TaskEnd::Kind kind) {
  TaskEnd end{.kind = kind, .seconds = seconds_of(worker)};
  end.status = end_process(worker.process, kind == TaskEnd::Kind::timed_out ? SIGTERM : 0);
  ::close(worker.socket);
  if (worker.state == Worker::State::working) one_is_alone_ = false;
  for (; worker.tasks.size() > 1; worker.tasks.pop_back()) held_.push_front(std::move(worker.tasks.back()));
  worker = {};
  return end;
}

}  // namespace standoff::cli
