#include "child.h"

#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <system_error>

namespace difi::bench {
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

/// All there is until the other end closes.
std::vector<double> read_all(int file) {
  std::vector<double> values;
  std::vector<char> bytes;
  char some[1 << 16];
  for (ssize_t size; (size = read(file, some, sizeof some)) != 0;) {
    if (size < 0) fail("pipe");
    bytes.insert(bytes.end(), some, some + size);
  }
  values.resize(bytes.size() / sizeof(double));
  std::copy_n(bytes.begin(), values.size() * sizeof(double), reinterpret_cast<char*>(values.data()));
  return values;
}

[[noreturn]] void be_child(int file, double limit_s, const std::function<std::vector<double>()>& job) {
  const auto soft = static_cast<rlim_t>(std::ceil(limit_s));
  const rlimit time{soft, soft + 1}, no_core{0, 0};
  setrlimit(RLIMIT_CPU, &time);  // SIGXCPU at the first, SIGKILL at the second
  setrlimit(RLIMIT_CORE, &no_core);
  try {
    const std::vector<double> values = job();
    _exit(write_all(file, reinterpret_cast<const char*>(values.data()), values.size() * sizeof(double)) ? 0 : 1);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    _exit(1);
  }
}

}  // namespace

std::optional<std::vector<double>> run_in_child(double limit_s, const std::function<std::vector<double>()>& job) {
  int ends[2];
  if (pipe(ends) != 0) fail("pipe");
  const pid_t child = fork();
  if (child < 0) fail("fork");
  if (child == 0) be_child(ends[1], limit_s, job);
  close(ends[1]);
  std::vector<double> values = read_all(ends[0]);
  close(ends[0]);
  int status = 0;
  if (waitpid(child, &status, 0) != child) fail("waitpid");
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU) return {};
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) throw std::runtime_error("a measuring process failed");
  return values;
}

}  // namespace difi::bench
