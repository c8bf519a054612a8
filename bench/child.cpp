// SPDX-License-Identifier: Apache-2.0
#include "child.h"

#include <poll.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <ctime>
#include <stdexcept>
#include <string>
#include <system_error>

namespace standoff::bench {
namespace {

[[noreturn]] void fail(const std::string& what) { throw std::system_error(errno, std::generic_category(), what); }

bool write_all(int file, const char* bytes, std::size_t size) {
  while (size > 0) {
    const ssize_t written = write(file, bytes, size);
    if (written <= 0) return false;
    bytes += written;
    size -= static_cast<std::size_t>(written);
  }
  return true;
}

[[noreturn]] void be_child(int file, const std::function<std::vector<double>()>& job) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);  // nothing else would stop it
  try {
    const std::vector<double> values = job();
    _exit(write_all(file, reinterpret_cast<const char*>(values.data()), values.size() * sizeof(double)) ? 0 : 1);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    _exit(1);
  }
}

/// The child's processor time so far. (A limit set with setrlimit would need no watching, but makes Linux count that
/// time in ticks of some milliseconds.)
double seconds_of(pid_t child) {
  clockid_t clock;
  timespec used{};
  if (clock_getcpuclockid(child, &clock) != 0 || clock_gettime(clock, &used) != 0) fail("the clock of a child");
  return static_cast<double>(used.tv_sec) + 1e-9 * static_cast<double>(used.tv_nsec);
}

/// Reads until the other end closes; nothing if the child's time is up before.
std::optional<std::vector<char>> read_until(double limit_s, int file, pid_t child) {
  std::vector<char> bytes;
  for (double left_s = limit_s;;) {
    pollfd waiting{file, POLLIN, 0};
    const int ready = poll(&waiting, 1, 1 + static_cast<int>(1000 * left_s));
    if (ready < 0 && errno == EINTR) continue;
    if (ready < 0) fail("poll");
    if (ready == 0) {
      left_s = limit_s - seconds_of(child);
      if (left_s <= 0) return {};
      continue;
    }
    char some[1 << 16];
    const ssize_t size = read(file, some, sizeof some);
    if (size < 0 && errno == EINTR) continue;
    if (size < 0) fail("read");
    if (size == 0) return bytes;
    bytes.insert(bytes.end(), some, some + size);
  }
}

}  // namespace

std::optional<std::vector<double>> run_in_child(double limit_s, const std::function<std::vector<double>()>& job) {
  int ends[2];
  if (pipe(ends) != 0) fail("pipe");
  const pid_t child = fork();
  if (child < 0) fail("fork");
  if (child == 0) be_child(ends[1], job);
  close(ends[1]);
  const std::optional<std::vector<char>> bytes = read_until(limit_s, ends[0], child);
  close(ends[0]);
  if (!bytes) kill(child, SIGKILL);
  int status = 0;
  if (waitpid(child, &status, 0) != child) fail("waitpid");
  if (!bytes) return {};
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) throw std::runtime_error("a measuring process failed");
  std::vector<double> values(bytes->size() / sizeof(double));
  std::copy_n(bytes->begin(), values.size() * sizeof(double), reinterpret_cast<char*>(values.data()));
  return values;
}

}  // namespace standoff::bench
