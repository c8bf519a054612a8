// SPDX-License-Identifier: Apache-2.0
#include "files/open_pipe.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>

#include <cerrno>

#include "core/progress.h"

namespace standoff {
namespace {

void (*notice)(const std::string&) = nullptr;

constexpr int kStepMs = 50, kStepsToNotice = 1000 / kStepMs;

void wait_a_step(pollfd* event) { ::poll(event, event ? 1 : 0, kStepMs); }

void tell(const std::filesystem::path& path, const char* what) {
  if (notice) notice(path.string() + ": " + what);
}

bool is_pipe(int file) {
  struct stat about {};
  return file >= 0 && ::fstat(file, &about) == 0 && S_ISFIFO(about.st_mode);
}

// From here on calls wait as usual.
void make_blocking(int file) { (void)!::fcntl(file, F_SETFL, ::fcntl(file, F_GETFL) & ~O_NONBLOCK); }

}  // namespace

void set_pipe_notice(void (*wanted)(const std::string&)) noexcept { notice = wanted; }

Descriptor open_to_read(const std::filesystem::path& path, ProgressMeter* waiting) {
  // A call that waits for a writer by itself would tell nobody, and on some threads nothing could stop it.
  Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (file.number() < 0) return file;
  if (is_pipe(file.number()))
    for (int steps = 1;; ++steps) {
      pollfd data{file.number(), POLLIN, 0};
      wait_a_step(&data);
      if (data.revents != 0) break;
      if (waiting) waiting->check();
      if (steps == kStepsToNotice)
        tell(path, "nothing has come through this pipe for a second; waiting for a program to write to it");
    }
  make_blocking(file.number());
  return file;
}

Descriptor open_to_write(const std::filesystem::path& path, const std::filesystem::path& shown) {
  for (int steps = 1;; ++steps) {
    Descriptor file(::open(path.c_str(), O_WRONLY | O_CLOEXEC | O_NONBLOCK));
    if (file.number() >= 0) {
      make_blocking(file.number());
      return file;
    }
    if (errno != ENXIO) return file;
    struct stat about {};
    if (::stat(path.c_str(), &about) != 0 || !S_ISFIFO(about.st_mode)) {
      errno = ENXIO;
      return file;
    }
    wait_a_step(nullptr);
    if (steps == kStepsToNotice)
      tell(shown, "nobody has opened this pipe for a second; waiting for a program to read it");
  }
}

}  // namespace standoff
