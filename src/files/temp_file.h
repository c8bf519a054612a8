// SPDX-License-Identifier: Apache-2.0
// Files that are gone at the end: with a name that others are given, without one, and the names of unfinished files for
// signal handlers.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "files/descriptor.h"

namespace standoff {

/// In the system's folder for such files, readable by its owner alone. Removed at the end, and where a signal ends the
/// program (remove_unfinished_files()).
class TempFile {
 public:
  /// `suffix` is the end of its name, ".obj". Errors: output.
  TempFile(std::string_view suffix, std::string_view bytes);
  TempFile(const TempFile&) = delete;
  TempFile& operator=(const TempFile&) = delete;
  ~TempFile();
  const std::filesystem::path& path() const { return path_; }

 private:
  void remove() noexcept;

  std::filesystem::path path_;
  int slot_ = -1;
};

// The names of unfinished files, kept where a signal handler can reach them.

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

// Bytes put aside on the disk until it is known where they go.

/// A file without a name: whatever happens, nothing of it is left. Every member throws Error{output}.
class SpoolFile {
 public:
  /// In that folder, whose disk has room for what is to become of the bytes. `shown` stands in messages.
  SpoolFile(const std::filesystem::path& folder, const std::filesystem::path& shown);
  void write(const void* data, std::size_t bytes);
  std::uint64_t size() const { return size_; }
  /// Calls use(bytes) for all bytes, front to back, a part at a time. Nothing may be written after it.
  template <class Use>
  void read_back(const Use& use) {
    flush();
    for (std::uint64_t at = 0; at < size_;) {
      const std::span<const std::byte> part = part_at(at);
      use(part);
      at += part.size();
    }
  }

 private:
  void flush();
  std::span<const std::byte> part_at(std::uint64_t offset);
  [[noreturn]] void fail(int error) const;

  std::filesystem::path shown_;
  Descriptor file_;
  std::uint64_t size_ = 0;
  std::vector<std::byte> buffer_;  // what is not written yet, then what was read
};

}  // namespace standoff
