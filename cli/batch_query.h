// SPDX-License-Identifier: Apache-2.0
// Many questions at once: files with a pose or motion on each line, and what the batches of collide, distance and sweep
// share.
#pragma once

#include <chrono>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>

#include "cli/console.h"
#include "cli/files.h"
#include "standoff/collision.h"

namespace standoff::cli {

/// The poses in a file; "-" is the standard input. A line holds the numbers of one pose as --pose takes them, with
/// commas between them; what follows a # is a comment, and empty lines are left out. A file without a pose has
/// none. Errors: input, as `FILE:LINE: what`.
std::vector<Pose> read_poses(const std::string& name);
/// The same with the numbers of two poses on a line: where the motion begins, and where it ends.
std::vector<RigidMotion> read_motions(const std::string& name, Vec3 center);

/// The help of --poses.
inline constexpr const char* kPosesHelp =
    "where B is, many times: a file with a --pose on each line,\n- for standard input";

/// Rows of a table with commas between cells.
class Table {
 public:
  explicit Table(const char* head) : text_(std::string(head) + '\n') {}

  void cell(const std::string& text) {
    if (begun_) text_ += ',';
    text_ += text;
    begun_ = true;
  }
  void cell(std::int64_t n) { cell(std::to_string(n)); }
  void cell(double value);
  /// Three cells, empty where there is no point.
  void point(bool there, Vec3 point);
  /// Empty for kNoTriangle.
  void triangle(std::uint32_t index);
  void end_row() { text_ += '\n', begun_ = false; }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
  bool begun_ = false;
};

/// The answers: the table, and how many there are of each kind.
struct Answers {
  Table table;
  std::vector<std::pair<const char*, std::int64_t>> counts;  ///< {"hit", 12}; the words are keys of `counts`
};

class BatchQuery {
 public:
  /// Adds the option `name` for the file of `noun`s ("pose"), and -o, -f and -j, which need it.
  CLI::Option* add_to(CLI::App& verb, const char* name, const char* help, const char* noun);
  /// Adds --device, which needs it too.
  void add_device_to(CLI::App& verb);

  bool given() const { return !file_.empty(); }
  const std::string& file() const { return file_; }
  const Execution& execution() const { return execution_; }
  /// Checks the output before any work.
  void check(std::initializer_list<std::string> inputs) const;

  /// Returns the results of ask(), and notes its report and how long that took.
  template <class Ask>
  auto answers(const Console& console, std::size_t count, Ask ask) {
    using Clock = std::chrono::steady_clock;
    count_ = static_cast<std::int64_t>(count);
    if (count == 0) warn_of_none(console, file_, noun_);
    const auto start = Clock::now();
    auto found = with_spinner(console, asked(), ask);
    seconds_ = std::chrono::duration<double>(Clock::now() - start).count();
    report_ = std::move(found.report);
    return std::move(found.results);
  }
  /// Writes the table to its file, or to stdout unless JSON is asked for; then says what was found.
  void deliver(const char* verb, const Answers& answers, const Console& console) const;

 private:
  std::string asked() const;

  const char* noun_ = "";
  CLI::Option* option_ = nullptr;
  std::string file_;
  FileOutput output_;
  Execution execution_;
  BatchReport report_;
  std::int64_t count_ = 0;
  double seconds_ = 0;
};

}  // namespace standoff::cli
