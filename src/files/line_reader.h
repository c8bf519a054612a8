// SPDX-License-Identifier: Apache-2.0
// The lines of tables in text: poses, motions, points. Of any length in all, in constant memory.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "files/input_stream.h"

namespace standoff {

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
