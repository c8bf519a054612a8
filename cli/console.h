// SPDX-License-Identifier: Apache-2.0
// What the program says: people's messages and the progress bar on stderr, data on stdout.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>

#include "cli/json.h"
#include "standoff/compute.h"

namespace standoff::cli {

/// The options that say how much is told, and how.
class Console {
 public:
  enum Offer { kMessages = 1, kJson = 2, kProgress = 4 };
  /// Adds --quiet and --verbose, --json and --progress to a verb, as `offers` asks.
  void add_to(CLI::App& verb, int offers);

  bool json() const { return json_; }
  /// A line on stderr, unless quiet.
  void say(const std::string& line) const;
  /// A line on stderr when verbose.
  void detail(const std::string& line) const;
  /// A line on stderr, always: the result is good, but not what one may think.
  void warn(const std::string& line) const;
  /// Whether stderr is a terminal whose user wants to see how far work has come.
  bool shows_progress() const;
  /// A callback for long work, which draws a bar when stderr is a terminal and stops the work on a signal.
  std::function<bool(const Progress&)> progress() const;

 private:
  bool quiet_ = false;
  bool verbose_ = false;
  bool json_ = false;
  std::string progress_ = "auto";
};

/// Says that a file of "point"s holds none: its answers have no rows, which is no error, but may be one before us.
void warn_of_none(const Console& console, const std::string& file, const std::string& noun);

/// Has the library tell on stderr that it waits for the other end of a pipe.
void tell_of_pipes();

/// Text on stdout. Throws Error{output} when it cannot be written.
void print(const std::string& text);
/// One object or list on stdout.
void print(const Json& json);

/// The same once a file was written: should stdout fail, the message says that the file is there, whole.
void print(const std::string& text, const std::filesystem::path& written);
void print(const Json& json, const std::filesystem::path& written);

}  // namespace standoff::cli
