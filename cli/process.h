// SPDX-License-Identifier: Apache-2.0
// The process: signals end it without leaving anything half-written, exceptions become exit codes, and how much memory
// it took.
#pragma once

#include <cstdint>
#include <functional>
#include <string_view>

namespace standoff::cli {

/// Installs the handlers. Signals that the parent has set to be ignored (nohup) stay ignored. A closed pipe and a file
/// past its size limit become ordinary write errors; a file that is shortened while it is read ends the program with a
/// message.
void install_signal_handlers();

/// While one lives, the first signal only makes interrupted() true, for work that asks; a second one ends the program.
/// While none lives, the first one does.
class Cancellable {
 public:
  Cancellable();
  Cancellable(const Cancellable&) = delete;
  Cancellable& operator=(const Cancellable&) = delete;
  ~Cancellable();
};

bool interrupted();

/// Returns the message of the interrupt, without a line's end: whether the output file is complete, and that what went
/// to a pipe or the standard output is cut off. The text lives until the next call. Async-signal-safe.
std::string_view interruption();

/// Says which of several files that were asked for is written last. Call it once, before the first is written.
void last_file_is(std::string_view name);

/// Says how a run that is interrupted goes on, in place of "run it again". Empty: as before.
void next_step_is(std::string_view text);

/// Says that data goes to the standard output, which an interrupt would cut off.
void output_has_begun();
/// Says that the standard output is a pipe that nobody reads any more: an ErrorCode::output ends the program without a
/// line then.
void output_has_no_reader();

/// Notes whether a line is drawn on the terminal: the message of a signal wipes it first.
void line_is_drawn(bool drawn);
bool is_line_drawn();

/// Runs the program and returns its exit code: 0, or what ErrorCode says for an exception, after one line on stderr of
/// the form `standoff: error: what; what to do`.
int exit_code_of(const std::function<void()>& run);

/// The most memory this process has held at any time.
std::int64_t peak_memory_bytes();

}  // namespace standoff::cli
