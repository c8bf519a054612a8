// SPDX-License-Identifier: Apache-2.0
// Runs the standoff program as a user does, in an empty folder of the test's own.
#pragma once

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/paths.h"
#include "tests/support/temp_folder.h"

namespace standoff::testing {

using Arguments = std::vector<std::string>;
using Json = nlohmann::json;

/// What a run left: its exit code (128 + signal when killed), and what it said.
struct Ran {
  int code = -1;
  std::string out;
  std::string err;

  Json json() const { return Json::parse(out); }
  bool says(const std::string& words) const { return err.find(words) != std::string::npos; }
};

/// A running program. Its stdout and stderr are pipes unless files are given for them.
class Process {
 public:
  struct Setup {
    std::string folder;  ///< to start in
    int in = -1;         ///< file descriptors to use in place of nothing to read
    int out = -1;        ///< and in place of pipes
    int err = -1;
    rlim_t file_size = RLIM_INFINITY;
    rlim_t memory = RLIM_INFINITY;  ///< address space
    bool ignore_hangup = false;     ///< as nohup does
  };

  Process(const Arguments& arguments, const Setup& setup) {
    if (setup.out < 0) open_pipe(out_);
    if (setup.err < 0) open_pipe(err_);
    Arguments words{std::string(kBinaryFolder) + "/standoff"};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> argv;
    for (auto& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    pid_ = ::fork();
    if (pid_ == 0) {
      const int null = ::open("/dev/null", O_RDONLY);
      ::dup2(setup.in < 0 ? null : setup.in, STDIN_FILENO);
      ::dup2(setup.out < 0 ? out_[1] : setup.out, STDOUT_FILENO);
      ::dup2(setup.err < 0 ? err_[1] : setup.err, STDERR_FILENO);
      for (const int signal : {SIGINT, SIGTERM, SIGPIPE, SIGXFSZ}) ::signal(signal, SIG_DFL);
      ::signal(SIGHUP, setup.ignore_hangup ? SIG_IGN : SIG_DFL);
      if (setup.file_size != RLIM_INFINITY) {
        const rlimit limit{setup.file_size, setup.file_size};
        ::setrlimit(RLIMIT_FSIZE, &limit);
      }
      if (setup.memory != RLIM_INFINITY) {
        const rlimit limit{setup.memory, setup.memory};
        ::setrlimit(RLIMIT_AS, &limit);
      }
      if (::chdir(setup.folder.c_str()) != 0) ::_exit(126);
      ::execv(argv[0], argv.data());
      ::_exit(127);
    }
    close_end(out_[1]);
    close_end(err_[1]);
  }
  Process(const Process&) = delete;
  Process& operator=(const Process&) = delete;
  ~Process() {
    if (pid_ > 0) {
      ::kill(pid_, SIGKILL);
      ::waitpid(pid_, nullptr, 0);
    }
    close_end(out_[0]);
    close_end(err_[0]);
  }

  void send(int signal) const { ::kill(pid_, signal); }
  pid_t pid() const { return pid_; }
  void close_out() { close_end(out_[0]); }

  /// Reads until stderr holds the words or ends; false in the latter case.
  bool wait_for(const std::string& words) {
    while (ran_.err.find(words) == std::string::npos)
      if (!read_some()) return false;
    return true;
  }

  /// Reads all that is said, and waits for the end.
  Ran wait() {
    while (read_some()) {
    }
    int status = 0;
    ::waitpid(pid_, &status, 0);
    pid_ = -1;
    ran_.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    return ran_;
  }

 private:
  static void open_pipe(int (&ends)[2]) {
    if (::pipe2(ends, O_CLOEXEC) != 0) ADD_FAILURE() << "no pipe";
  }
  static void close_end(int& end) {
    if (end >= 0) ::close(end);
    end = -1;
  }

  // Whatever comes next on either pipe; false when both have ended.
  bool read_some() {
    pollfd ready[] = {{out_[0], POLLIN, 0}, {err_[0], POLLIN, 0}};
    if (out_[0] < 0 && err_[0] < 0) return false;
    if (::poll(ready, 2, -1) < 0) return errno == EINTR;
    take(ready[0], out_[0], ran_.out);
    take(ready[1], err_[0], ran_.err);
    return true;
  }
  static void take(const pollfd& ready, int& end, std::string& text) {
    if (end < 0 || ready.revents == 0) return;
    char buffer[4096];
    const auto count = ::read(end, buffer, sizeof buffer);
    if (count > 0)
      text.append(buffer, static_cast<std::size_t>(count));
    else if (count == 0 || errno != EINTR)
      close_end(end);
  }

  pid_t pid_ = -1;
  int out_[2] = {-1, -1};
  int err_[2] = {-1, -1};
  Ran ran_;
};

/// A test of the program: `folder` is where it runs.
class ProgramTest : public ::testing::Test {
 protected:
  TempFolder folder;

  Process::Setup setup() const {
    Process::Setup setup;
    setup.folder = folder.path().string();
    return setup;
  }
  Ran run(const Arguments& arguments) const { return Process(arguments, setup()).wait(); }
  Ran run(const Arguments& arguments, const Process::Setup& how) const { return Process(arguments, how).wait(); }
  /// A run that must end with this exit code and say this.
  Ran refused(const Arguments& arguments, const Process::Setup& how, int code, const std::string& part) const {
    Ran ran = run(arguments, how);
    EXPECT_EQ(ran.code, code) << ::testing::PrintToString(arguments) << ran.err;
    EXPECT_TRUE(ran.says(part)) << ::testing::PrintToString(arguments) << ran.err << "lacks " << part;
    return ran;
  }
  Ran refused(const Arguments& arguments, int code, const std::string& part) const {
    return refused(arguments, setup(), code, part);
  }
  /// A run that must succeed.
  Ran done(const Arguments& arguments) const {
    Ran ran = run(arguments);
    EXPECT_EQ(ran.code, 0) << ran.err;
    return ran;
  }
};

/// Command lines are easier to read as one text; words are parted by blanks.
inline Arguments words(const std::string& text) {
  Arguments found;
  std::string word;
  for (const char c : text + " ")
    if (c != ' ')
      word += c;
    else if (!word.empty())
      found.push_back(std::exchange(word, ""));
  return found;
}

}  // namespace standoff::testing
