// SPDX-License-Identifier: Apache-2.0
#include "cli/console.h"

#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <system_error>

#include "cli/parse.h"
#include "cli/process.h"
#include "cli/text.h"
#include "cli/time_left.h"
#include "files/file_view.h"
#include "standoff/error.h"

namespace standoff::cli {
namespace {

constexpr std::chrono::milliseconds kFirstDrawn{100},
    kDrawnEach{100};  // short work gets no bar, long work ten a second

// Draws a line on the terminal again and again, and wipes it at the end: when it is told of progress and, with a thread
// of its own, meanwhile.
class Bar {
 public:
  explicit Bar(bool own_thread) {
    if (!own_thread) return;
    try {
      thread_ = std::thread([this] { draw_until_over(); });
    } catch (const std::system_error&) {
      // Without a thread the bar moves when there is progress.
    }
  }
  Bar(const Bar&) = delete;
  Bar& operator=(const Bar&) = delete;
  ~Bar() {
    {
      const std::lock_guard lock(mutex_);
      over_ = true;
    }
    ended_.notify_one();
    if (thread_.joinable()) thread_.join();
    if (!drawn_) return;
    std::fputs("\r\033[K", stderr);
    line_is_drawn(false);
  }

  void tell(const Progress& progress) {
    const std::lock_guard lock(mutex_);
    stage_ = progress.stage;
    fraction_ = progress.fraction;
    if (!thread_.joinable()) draw();
  }

 private:
  using Clock = std::chrono::steady_clock;

  void draw_until_over() {
    std::unique_lock lock(mutex_);
    while (!ended_.wait_for(lock, kDrawnEach, [this] { return over_; })) draw();
  }

  // Call it with the mutex locked.
  void draw() {
    const auto now = Clock::now();
    if (stage_.empty() || now - start_ < kFirstDrawn || now - last_ < kDrawnEach / 2) return;
    last_ = now;
    drawn_ = true;
    line_is_drawn(true);
    constexpr int kWidth = 30;
    const int filled = static_cast<int>(fraction_ * kWidth);
    std::string line = "\r\033[K[" + std::string(filled, '#') + std::string(kWidth - filled, '.') + "] ";
    line += std::to_string(static_cast<int>(fraction_ * 100)) + " % " + stage_;
    if (const auto left = left_.at(std::chrono::duration<double>(now - start_).count(), fraction_))
      line += ", " + time_left_text(*left);
    std::fputs(line.c_str(), stderr);
    std::fflush(stderr);
  }

  const Clock::time_point start_ = Clock::now();
  Clock::time_point last_{};
  TimeLeft left_;
  bool drawn_ = false, over_ = false;
  std::string stage_;
  double fraction_ = 0;
  std::mutex mutex_;
  std::condition_variable ended_;
  std::thread thread_;
};

void to_stderr(const std::string& line) { std::fprintf(stderr, "%s\n", message_line(line).c_str()); }

}  // namespace

void Console::add_to(CLI::App& verb, int offers) {
  constexpr const char* kGroup = "Messages";
  if (offers & kJson) verb.add_flag("--json", json_, "print one JSON object on stdout")->group(kGroup);
  if (offers & kMessages) {
    auto* quiet = verb.add_flag("-q,--quiet", quiet_, "say nothing but errors and warnings")->group(kGroup);
    verb.add_flag("-v,--verbose", verbose_, "say more")->group(kGroup)->excludes(quiet);
  }
  if (offers & kProgress)
    verb.add_option("--progress", progress_, "auto: a progress bar on a terminal (default); never: none")
        ->option_text("WHEN")
        ->group(kGroup)
        ->each([](const std::string& text) {
          parse_choice("--progress", text, {"auto", "never"});
        });
}

void Console::say(const std::string& line) const {
  if (!quiet_) to_stderr(line);
}

void Console::detail(const std::string& line) const {
  if (verbose_) to_stderr(line);
}

void Console::warn(const std::string& line) const { to_stderr("standoff: warning: " + line); }

bool Console::shows_progress() const { return progress_ == "auto" && !quiet_ && ::isatty(STDERR_FILENO); }

std::function<bool(const Progress&)> Console::progress(bool own_thread) const {
  const auto bar = shows_progress() ? std::make_shared<Bar>(own_thread) : nullptr;
  return [bar](const Progress& progress) {
    if (bar) bar->tell(progress);
    return !interrupted();
  };
}

void warn_of_none(const Console& console, const std::string& file, const std::string& noun) {
  console.warn((file == "-" ? "standard input" : file) + ": there is no " + noun + " in it, and so no answer");
}

void say_sign(const Console& console, const SignReport& sign) {
  if (sign.why.empty()) return;
  const std::string line =
      (sign.method == SignMethod::none ? "no sign" : std::string("sign by ") + name_of(sign.method)) + ": " + sign.why;
  sign.sure ? console.say(line) : console.warn(line + "; not certain");
}

void tell_of_pipes() {
  set_pipe_notice([](const std::string& sentence) {
    if (is_line_drawn()) std::fputs("\r\033[K", stderr);
    to_stderr("standoff: warning: " + sentence);
  });
}

void print(const std::string& text) {
  output_has_begun();
  if (std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0) return;
  if (errno == EPIPE) output_has_no_reader();
  throw Error(ErrorCode::output,
              "standard output: cannot write to it: " + std::string(std::strerror(errno)) + "; send it elsewhere");
}

void print(const Json& json) { print(json_text(json)); }

void print(const std::string& text, const std::filesystem::path& written) {
  try {
    print(text);
  } catch (const Error& error) {
    throw Error(error.code(),
                std::string(error.what()) + "; " + written.string() + " was written before, and is whole");
  }
}

void print(const Json& json, const std::filesystem::path& written) { print(json_text(json), written); }

Spinner::Spinner(const Console& console, const std::string& what) : what_(one_line(what)) {
  if (!console.shows_progress()) return;
  try {
    thread_ = std::thread([this] { show(); });
  } catch (const std::system_error&) {
    // Without a thread the terminal stays silent.
  }
}

Spinner::~Spinner() {
  if (!thread_.joinable()) return;
  {
    const std::lock_guard lock(mutex_);
    over_ = true;
  }
  ended_.notify_one();
  thread_.join();
}

void Spinner::show() {
  const auto start = std::chrono::steady_clock::now();
  std::unique_lock lock(mutex_);
  if (ended_.wait_for(lock, kFirstDrawn, [this] { return over_; })) return;
  line_is_drawn(true);
  do {
    const double elapsed = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    std::fprintf(stderr, "\r\033[K%s, %s", what_.c_str(), seconds_text(elapsed).c_str());
    std::fflush(stderr);
  } while (!ended_.wait_for(lock, kDrawnEach, [this] { return over_; }));
  std::fputs("\r\033[K", stderr);
  line_is_drawn(false);
}

}  // namespace standoff::cli
