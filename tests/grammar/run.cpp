// SPDX-License-Identifier: Apache-2.0
#include "tests/grammar/run.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstring>
#include <new>
#include <system_error>

#include "tests/grammar/judge.h"
#include "tests/grammar/memory.h"

namespace standoff::grammar {
namespace {

constexpr int kOverMemory = 77;         // the exit code of a child that went past its bound
constexpr std::uint64_t kBatch = 200;   // files a child reads: a fork costs as much as a few files
constexpr std::size_t kMostFaults = 6;  // wrong answers that are told and kept; of deaths, which are rarer, all
constexpr double kWaitsTooLong = 4;     // times the bound, on the clock; the processor may be busy with others
#ifdef STANDOFF_SANITIZED
constexpr double kSlower = 10;
#else
constexpr double kSlower = 1;
#endif

// What a child tells its parent, also when it does not live to say so.
struct Shared {
  std::uint64_t next;  // the file that is being read, or comes next
  bool made;           // it is; before, the grammar itself is at work
  std::uint64_t read, refused, good, compared, wrong;
  double longest_s;
  std::size_t most_bytes;
  std::size_t faults;
  char fault[kMostFaults][700];
};

std::string fault_text(std::uint64_t seed, const std::string& what) {
  return "seed " + std::to_string(seed) + ": " + what;
}

[[noreturn]] void leave_over_memory() { ::_exit(kOverMemory); }

// Ends the process when it computes, or waits, for too long.
void set_timers(double seconds) {
  const auto set = [](int which, double s) {
    itimerval timer{};
    timer.it_value.tv_sec = static_cast<time_t>(s);
    timer.it_value.tv_usec = static_cast<suseconds_t>((s - static_cast<double>(timer.it_value.tv_sec)) * 1e6);
    ::setitimer(which, &timer, nullptr);
  };
  set(ITIMER_PROF, seconds * kSlower);
  set(ITIMER_REAL, seconds * kSlower * kWaitsTooLong);
}

void read_files(const Grammar& grammar, std::uint64_t end, const std::filesystem::path& folder, const Bounds& bounds,
                Shared& shared) {
  for (; shared.next < end; ++shared.next) {
    shared.made = false;
    Choices choices(shared.next);
    const File file = grammar.make(choices);
    const std::filesystem::path path = put(grammar, file, folder);
    const bool good = choices.tricks() == 0;
    std::size_t size = file.bytes.size();
    for (const auto& [name, bytes] : file.beside) size += bytes.size();
    shared.made = true;
    set_timers(bounds.seconds);
    watch_memory(bounds.times_its_size * size + bounds.and_bytes, leave_over_memory);
    const auto began = std::chrono::steady_clock::now();
    const Verdict verdict = judge(grammar, file, good, path);
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - began;
    shared.most_bytes = std::max(shared.most_bytes, peak_memory());
    set_timers(0);
    shared.longest_s = std::max(shared.longest_s, took.count());
    ++(verdict.read ? shared.read : shared.refused);
    shared.good += good && (verdict.read || !file.may_be_refused);
    shared.compared += verdict.compared && verdict.fault.empty();
    if (verdict.fault.empty()) continue;
    ++shared.wrong;
    if (shared.faults == kMostFaults) continue;
    const std::string text = fault_text(shared.next, verdict.fault);
    text.copy(shared.fault[shared.faults++], std::min(text.size(), sizeof shared.fault[0] - 1));
    std::filesystem::create_directory(folder / "bad");
    std::filesystem::rename(path, folder / "bad" / (std::to_string(shared.next) + path.extension().string()));
  }
}

[[noreturn]] void be_child(const Grammar& grammar, std::uint64_t end, const std::filesystem::path& folder,
                           const Bounds& bounds, Shared& shared) {
  const rlimit none{0, 0};
  ::setrlimit(RLIMIT_CORE, &none);
  // A reader that asks stdin waits, as at a pipe.
  ::dup2(::open((folder / kPipe).c_str(), O_RDWR | O_CLOEXEC), STDIN_FILENO);
  try {
    read_files(grammar, end, folder, bounds, shared);
  } catch (...) {
    ::abort();  // what judge() does not catch is no answer
  }
  ::_exit(0);
}

void count_death(int status, const Grammar& grammar, const Shared& shared, Tally& tally) {
  const int signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  std::string what = signal ? "crashed, signal " + std::to_string(signal)
                            : "ended the program, exit code " + std::to_string(WEXITSTATUS(status));
  if (signal == SIGPROF || signal == SIGALRM) {
    ++tally.hung;
    what = signal == SIGPROF ? "computes for too long" : "waits for too long";
  } else if (!signal && WEXITSTATUS(status) == kOverMemory) {
    ++tally.over_memory;
    what = "takes too much memory";
  } else {
    ++tally.crashed;
  }
  if (!shared.made) what = std::string("the grammar of ") + grammar.extension + " itself " + what;
  tally.faults.push_back(fault_text(shared.next, what));
}

// What a child died of is made once more. Not where making it was what it died of.
void keep(const Grammar& grammar, std::uint64_t seed, const std::filesystem::path& folder) {
  Choices again(seed);
  const std::filesystem::path path = put(grammar, grammar.make(again), folder);
  std::filesystem::create_directory(folder / "bad");
  std::filesystem::rename(path, folder / "bad" / (std::to_string(seed) + path.extension().string()));
}

}  // namespace

Tally run(const Grammar& grammar, std::uint64_t first, std::uint64_t count, const std::filesystem::path& folder,
          const Bounds& bounds) {
  void* mapped = ::mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (mapped == MAP_FAILED) throw std::system_error(errno, std::generic_category(), "mmap");
  Shared& shared = *new (mapped) Shared{};
  shared.next = first;
  Tally tally;
  while (shared.next < first + count) {
    const std::uint64_t end = std::min(first + count, (shared.next / kBatch + 1) * kBatch);
    const pid_t child = ::fork();
    if (child < 0) throw std::system_error(errno, std::generic_category(), "fork");
    if (child == 0) be_child(grammar, end, folder, bounds, shared);
    int status = 0;
    while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    if (status == 0) continue;
    count_death(status, grammar, shared, tally);
    if (shared.made) keep(grammar, shared.next, folder);
    ++shared.next;
  }
  tally.files = count;
  tally.read = shared.read, tally.refused = shared.refused, tally.good = shared.good, tally.compared = shared.compared;
  tally.wrong = shared.wrong, tally.longest_s = shared.longest_s, tally.most_bytes = shared.most_bytes;
  for (std::size_t n = 0; n < shared.faults; ++n) tally.faults.emplace_back(shared.fault[n]);
  ::munmap(mapped, sizeof(Shared));
  return tally;
}

}  // namespace standoff::grammar
