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

/// Removes the temporary files of all writes in progress in this process. Async-signal-safe: call it from a handler of
/// SIGINT, SIGTERM or SIGHUP that ends the process next. Targets are never touched: a file that was being replaced
/// keeps its old content. Writes that go on afterwards may fail.
void remove_unfinished_files() noexcept;

}  // namespace standoff
