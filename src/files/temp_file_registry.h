// SPDX-License-Identifier: Apache-2.0
// The names of unfinished files, kept where a signal handler can reach them.
#pragma once

#include <filesystem>

namespace standoff {

/// Takes note of a file that remove_unfinished_files() shall remove. Returns its slot, or -1 when the table is full or
/// the name too long: then only the writer itself can remove it.
int note_unfinished(const std::filesystem::path& path) noexcept;

/// Frees a slot; -1 is ignored.
void forget_unfinished(int slot) noexcept;

/// Takes note that the file `file` (an open descriptor, or a folder's) is about to get the name `target`, its last
/// step.
void note_finishing(const std::filesystem::path& target, int file) noexcept;

/// The name that was noted last if the file, or folder, of that time has it by now: what was written is complete, even
/// if whoever wrote it has not come to know it. Else null. Async-signal-safe.
const char* finished_file() noexcept;

/// Counts the pipes and devices that are being written straight, and not to their end yet. Async-signal-safe.
void note_straight(int more) noexcept;
bool is_writing_straight() noexcept;

/// Removes the temporary files, and folders of files, of all writes in progress in this process. Async-signal-safe:
/// call it from a handler of SIGINT, SIGTERM or SIGHUP that ends the process next. Targets are never touched: a file
/// that was being replaced keeps its old content. Writes that go on afterwards may fail.
void remove_unfinished_files() noexcept;

}  // namespace standoff
