// SPDX-License-Identifier: Apache-2.0
// Open files of the system: one that closes itself, pipes that may have nobody at their other end, input that is read
// front to back, and its lines.
#pragma once

#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace standoff {

/// Closed at the end of its life; a number below zero is none.
class Descriptor {
 public:
  Descriptor() = default;
  explicit Descriptor(int number) : number_(number) {}
  Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }

  int number() const { return number_; }
  /// Leaves it open, to the caller.
  int release() { return std::exchange(number_, -1); }

 private:
  int number_ = -1;
};

// Named pipes that may have nobody at their other end: waiting for one can be stopped, and is said.

class ProgressMeter;

/// Opens what is read from front to back. Of a pipe it waits until something comes through it, or its writer has gone;
/// meanwhile `waiting`, if there is one, may stop it (Error{interrupted}). As ::open: below zero with errno.
Descriptor open_to_read(const std::filesystem::path& path, ProgressMeter* waiting = nullptr);

/// Opens a pipe or device that is there, which the caller calls `shown`. Of a pipe it waits until somebody reads it. As
/// ::open.
Descriptor open_to_write(const std::filesystem::path& path, const std::filesystem::path& shown);

/// What gets a sentence, "FILE: ..", once somebody has waited for a pipe for a second. None by default: a library does
/// not speak. Set it before any thread opens a file.
void set_pipe_notice(void (*notice)(const std::string& sentence)) noexcept;

// Input that is read front to back and never held as a whole: files larger than memory, pipes, the standard input.

/// Why a file cannot be read, and what to do, for a number of errno.
std::string cannot_read(int error);

class InputStream {
 public:
  /// Opens a file or a pipe; "-" is the standard input. Errors: input.
  explicit InputStream(const std::string& name);
  /// The caller's bytes, which must outlive it.
  InputStream(const std::string& name, std::string_view bytes) : name_(name), bytes_(bytes), size_(bytes.size()) {}

  /// Fills `to` with up to `room` bytes and returns how many they are: 0 at the end alone. Errors: input.
  std::size_t read(char* to, std::size_t room);
  /// What messages call it.
  const std::string& name() const { return name_; }
  /// The finished share, 0 to 1; 0 where the end is unknown.
  double fraction() const { return size_ > 0 ? static_cast<double>(done_) / static_cast<double>(size_) : 0; }

 private:
  std::string name_;
  std::string_view bytes_;  // what is left of the caller's
  Descriptor opened_;       // not that of the standard input, which stays open
  int file_ = -1;           // none: the caller's bytes
  std::uint64_t size_ = 0, done_ = 0;
};

// The lines of tables in text: poses, motions, points. Of any length in all, in constant memory.

/// Lines end with LF or CR LF, or with CR where the first of them ends so. What follows a # is a comment. A mark of
/// UTF-8 at the beginning, as spreadsheets write it, is passed over.
class LineReader {
 public:
  static constexpr std::size_t kLongestLine = std::size_t{1} << 20;

  explicit LineReader(InputStream input) : input_(std::move(input)) {}

  /// The next line that has content, without its comment and the blanks at its end; it lives until the next call. False
  /// at the end of the text. Errors: input (a line longer than kLongestLine).
  bool next(std::string_view& line);
  /// The number of that line, from 1.
  std::uint64_t number() const { return number_; }
  /// Throws Error{input} "NAME:line N: MESSAGE".
  [[noreturn]] void fail(const std::string& message) const { fail_at(number_, message); }
  /// The same of a line before it.
  [[noreturn]] void fail_at(std::uint64_t number, const std::string& message) const;
  double fraction() const { return input_.fraction(); }
  const std::string& name() const { return input_.name(); }

 private:
  bool next_raw(std::string_view& line);
  void begin();
  bool refill();

  InputStream input_;
  std::vector<char> buffer_;
  std::size_t at_ = 0, end_ = 0;  // what is not read yet
  bool begun_ = false, ended_ = false;
  char line_end_ = '\n';
  std::uint64_t number_ = 0;
};

}  // namespace standoff
