// SPDX-License-Identifier: Apache-2.0
#include "cli/process.h"

#include <sys/resource.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <new>
#include <string>

#include "cli/text.h"
#include "files/atomic_file.h"
#include "standoff/error.h"

namespace standoff::cli {
namespace {

std::atomic<bool> signalled{false};
std::atomic<int> cancellable_count{0};
std::atomic<bool> line_drawn{false};
std::atomic<bool> output_begun{false};
std::atomic<bool> output_unread{false};
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free);

// Holds text without allocating, as a signal handler must.
class FixedText {
 public:
  void clear() { size_ = 0; }
  void add(std::string_view words) {
    for (const char c : words)
      if (size_ < sizeof text_) text_[size_++] = c < ' ' && c >= 0 ? '?' : c;
  }
  std::string_view view() const { return {text_, size_}; }

 private:
  char text_[4500];
  std::size_t size_ = 0;
};

FixedText last_file;  // empty where there is but one
FixedText next_step;  // empty where it is to run it again

void say(std::string_view words) { (void)!::write(STDERR_FILENO, words.data(), words.size()); }

[[noreturn]] void end(std::string_view (*message)(), ErrorCode code) {
  remove_unfinished_files();
  if (line_drawn) say("\r\033[K");
  say("standoff: error: ");
  say(message());
  say("\n");
  ::_exit(static_cast<int>(code));
}

extern "C" void on_signal(int) {
  if (!signalled.exchange(true) && cancellable_count > 0) return;
  end(interruption, ErrorCode::interrupted);
}

// Field files are mapped: their pages vanish when another program shortens the file.
extern "C" void on_lost_file(int) {
  end(
      [] {
        return std::string_view(
            "a file that was being read became shorter or its disk failed; see who writes to it, run it again");
      },
      ErrorCode::input);
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
  std::signal(SIGBUS, on_lost_file);
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
}

Cancellable::Cancellable() { ++cancellable_count; }
Cancellable::~Cancellable() { --cancellable_count; }

bool interrupted() { return signalled; }

std::string_view interruption() {
  static FixedText text;
  text.clear();
  const char* const finished = finished_file();
  text.add("interrupted");
  if (finished) {
    text.add(" after ");
    text.add(finished);
    text.add(" was written, which is complete");
  }
  text.add("; no partial file was left");
  if (is_writing_straight()) text.add(", but what went to a pipe or device is cut off");
  if (output_begun) text.add(", but the standard output may be cut off");
  const bool more_follow = finished && !last_file.view().empty() && last_file.view() != finished;
  if (more_follow) {
    text.add(", but ");
    text.add(last_file.view());
    text.add(" was not written");
  }
  if (!next_step.view().empty()) {
    text.add(", ");
    text.add(next_step.view());
  } else if (!finished || more_follow) {
    text.add(", run it again");
  }
  return text.view();
}

void last_file_is(std::string_view name) { last_file.add(name); }
void next_step_is(std::string_view text) {
  next_step.clear();
  next_step.add(text);
}
void output_has_begun() { output_begun = true; }
void output_has_no_reader() { output_unread = true; }

void line_is_drawn(bool drawn) { line_drawn = drawn; }
bool is_line_drawn() { return line_drawn; }

namespace {

int fail(ErrorCode code, const std::string& message) {
  // Who stops reading, as head does, has what it wanted.
  if (code == ErrorCode::output && output_unread) return static_cast<int>(code);
  std::fprintf(stderr, "standoff: error: %s\n", message_line(message).c_str());
  return static_cast<int>(code);
}

// The library's messages name no options of the program, so the program adds them.
std::string with_options(const Error& error) {
  const std::string message = error.what();
  if (error.code() != ErrorCode::device || message.find("--device") != std::string::npos) return message;
  return message + " (standoff devices lists what there is; --device cpu takes the CPU)";
}

}  // namespace

int exit_code_of(const std::function<void()>& run) {
  try {
    run();
    return 0;
  } catch (const Error& error) {
    if (error.code() == ErrorCode::interrupted) return fail(error.code(), std::string(interruption()));
    return fail(error.code(), with_options(error));
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::limit, "not enough memory; use a smaller mesh or fewer samples, or provide more memory");
  } catch (const std::exception& error) {
    return fail(ErrorCode::internal,
                "internal: " + std::string(error.what()) + "; this is a bug in standoff, please report it");
  }
}

std::int64_t peak_memory_bytes() {
  struct rusage usage {};
  ::getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::int64_t>(usage.ru_maxrss) * 1024;
}

}  // namespace standoff::cli
