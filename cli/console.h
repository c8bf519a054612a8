// SPDX-License-Identifier: Apache-2.0
// What the program says: people's messages, the progress bar and what is waited for on stderr, data on stdout.
#pragma once

#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <type_traits>

#include <CLI/CLI.hpp>

#include "cli/json.h"
#include "cli/process.h"
#include "cli/text.h"
#include "standoff/compute.h"
#include "standoff/error.h"
#include "standoff/sign.h"

namespace standoff::cli {

/// The options that say how much is told, and how.
class Console {
 public:
  enum Offer { kMessages = 1, kJson = 2, kProgress = 4 };
  /// Adds --quiet and --verbose, --json and --progress to a verb, as `offers` asks.
  void add_to(CLI::App& verb, int offers);

  bool json() const { return json_; }
  /// Writes a line to stderr, unless quiet.
  void say(const std::string& line) const;
  /// Writes a line to stderr when verbose.
  void detail(const std::string& line) const;
  /// Writes a line to stderr, also when quiet: the result is valid, but may not be what the user expects.
  void warn(const std::string& line) const;
  /// Whether stderr is a terminal whose user wants to see how far work has come.
  bool shows_progress() const;
  /// A callback for long work, which draws a bar when stderr is a terminal and stops the work on a signal. The bar
  /// moves on by a thread of its own; without one, for work that forks and calls some ten times a second, when it is
  /// called.
  std::function<bool(const Progress&)> progress(bool own_thread = true) const;

 private:
  bool quiet_ = false;
  bool verbose_ = false;
  bool json_ = false;
  std::string progress_ = "auto";
};

/// Warns that a file holds no `noun` ("point"). Answers without rows are no error, but the file may be the wrong one.
void warn_of_none(const Console& console, const std::string& file, const std::string& noun);

/// Says how the sign was decided: as a warning, also when quiet, where that is not certain. Nothing of no sign asked
/// for.
void say_sign(const Console& console, const SignReport& sign);

/// Makes the library say on stderr when it waits for the other end of a pipe.
void tell_of_pipes();

/// Writes text to stdout. Throws Error{output} when that fails; of a pipe without a reader nothing is said then.
void print(const std::string& text);
/// Writes one object or list to stdout.
void print(const Json& json);

/// Does the same after a file was written: if stdout fails, the message says that the file is complete.
void print(const std::string& text, const std::filesystem::path& written);
void print(const Json& json, const std::filesystem::path& written);

/// While one lives, a terminal shows what is waited for and for how long, once that is longer than a moment. Elsewhere,
/// and where the user wants no progress shown, it does nothing.
class Spinner {
 public:
  /// `what` is short: "reading bunny.obj".
  Spinner(const Console& console, const std::string& what);
  Spinner(const Spinner&) = delete;
  Spinner& operator=(const Spinner&) = delete;
  ~Spinner();

 private:
  void show();

  std::string what_;
  std::mutex mutex_;
  std::condition_variable ended_;
  bool over_ = false;
  std::thread thread_;
};

/// Returns the result of work that tells `told` of its progress and can be interrupted, and meanwhile shows a bar.
/// Errors: interrupted.
template <class Work>
auto with_progress(const Console& console, ProgressCallback& told, Work work) {
  auto result = [&] {
    const Cancellable cancellable;
    told = console.progress();
    return work();
  }();
  told = nullptr;  // ends the bar
  if (interrupted()) throw Error(ErrorCode::interrupted, "interrupted");
  return result;
}

/// Returns the result of a verb's work on a mesh. Errors about a mesh in memory get the name of its file; Error{doubt}
/// also that of the verb: `FILE: VERB: the sign is not certain`.
template <class Work>
auto naming_mesh(const std::string& file, const char* verb, Work work) {
  try {
    return work();
  } catch (const Error& error) {
    const bool doubt = error.code() == ErrorCode::doubt;
    if (!doubt && (error.code() != ErrorCode::input || !error.details().file.empty())) throw;
    throw Error(error.code(), file + ": " + (doubt ? std::string(verb) + ": " : "") + error.what(), error.details());
  }
}

/// Returns the result of `work`, and meanwhile shows what is waited for. With --verbose it says how long that took.
template <class Work>
auto with_spinner(const Console& console, const std::string& what, Work work) {
  const auto start = std::chrono::steady_clock::now();
  const auto tell = [&] {
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
    console.detail(what + ": " + seconds_text(elapsed.count()));
  };
  const auto shown_work = [&] {
    const Spinner shown(console, what);
    return work();
  };
  if constexpr (std::is_void_v<decltype(work())>) {
    shown_work();
    tell();
  } else {
    auto result = shown_work();
    tell();
    return result;
  }
}

}  // namespace standoff::cli
