// SPDX-License-Identifier: Apache-2.0
// Output files that appear whole or not at all, the room for them on the disk, whole text files, temporary files, and
// the names of unfinished files for signal handlers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "files/file_view.h"
#include "standoff/existing.h"

namespace standoff {

class ProgressMeter;

/// Writes beside the target and takes its place on commit: once its bytes are on the disk, so that the target is the
/// old file or the new one whenever a process, or the machine, ends. Without a commit the target stays as it was and
/// nothing is left: on Linux the unfinished file has no name where the file system can do that, so even a killed
/// process leaves nothing; elsewhere it is called `.standoff-*.part`, and the destructor or remove_unfinished_files()
/// removes it. A symbolic link is followed; permissions of a replaced file are kept; devices and pipes are written
/// straight. Every member throws Error{output} as `FILE: what; what to do`.
class AtomicFile {
 public:
  enum class Unfinished {
    unnamed_if_possible,
    named,  ///< as on file systems that know no unnamed files; for tests
  };

  /// Opens the unfinished file. Refuses folders, missing parents, files that may not be written, and those to be kept.
  explicit AtomicFile(const std::filesystem::path& target, Existing existing = Existing::replace,
                      Unfinished unfinished = Unfinished::unnamed_if_possible);
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;
  ~AtomicFile();

  /// Lets the caller stop the work: from now on, writing throws Error{interrupted} once the meter's has asked to.
  void watched_by(ProgressMeter& waiting) { waiting_ = &waiting; }
  /// Throws if so: for work between the bytes, from any thread.
  void check() const;
  /// The system may write the bytes to the disk when it likes: commit() takes microseconds then. The file still appears
  /// whole or not at all for every process; after a loss of power it may be there without its bytes.
  void leave_to_system() { waits_for_disk_ = false; }
  /// The target as the caller gave it, for messages.
  const std::filesystem::path& target() const { return shown_; }
  /// Appends bytes, through a buffer when they are few.
  void write(const void* data, std::size_t bytes);
  /// Whether overwrite() may be called: not for pipes and devices.
  bool can_overwrite() const { return kind_ != Kind::straight; }
  /// Replaces bytes that were written before. Not for pipes.
  void overwrite(std::uint64_t offset, const void* data, std::size_t bytes);
  /// Bytes appended so far.
  std::uint64_t size() const { return size_; }
  /// Writes what is buffered and puts the file in the target's place; when it returns, a loss of power does not take
  /// the file away. It waits for the disk: milliseconds, and as long as the disk takes for the bytes. Nothing may be
  /// written after it. A target to be kept that has appeared since is an error; looking for it and taking its name is
  /// one step.
  void commit();

 private:
  bool open_unnamed();
  void open_named();
  void flush();
  void append(const char* data, std::size_t bytes);
  void close();
  void sync(int file) const;
  static void begin_to_sync(int file) noexcept;
  void sync_folder() const noexcept;
  void link_unnamed();
  void take_name();
  void discard() noexcept;
  [[noreturn]] void fail(int error) const;

  enum class Kind { straight, unnamed, named };

  std::filesystem::path shown_;   // the target as the caller wrote it, for messages
  std::filesystem::path target_;  // absolute, links followed
  std::filesystem::path folder_;  // the target's; known beforehand, for nothing may fail once the file is there
  std::filesystem::path unfinished_;
  Kind kind_ = Kind::named;
  Existing existing_;
  int file_ = -1;
  int slot_ = -1;  // in the table of unfinished files
  std::uint64_t size_ = 0;
  bool noted_straight_ = false;
  bool waits_for_disk_ = true;
  ProgressMeter* waiting_ = nullptr;
  std::unique_ptr<char[]> buffer_;
  std::size_t buffered_ = 0;
};

/// Throws Error{output} "SHOWN: cannot write it: WHY; WHAT TO DO" for a number of errno. `folder` is the file's.
[[noreturn]] void fail_to_write(const std::filesystem::path& shown, int error, const std::filesystem::path& folder);

/// The name of an unfinished file or folder: ".standoff-*.part", another one at each call and in each process.
std::string unfinished_name();

/// Where the links of a name end, even if nothing is there yet. Where they lead in a circle, opening the file says so.
std::filesystem::path end_of_links(std::filesystem::path path);

/// The bytes that the file system still takes where this file is, or is to be; nothing where it does not tell, and for
/// pipes and devices. An older file of the name counts as what is taken: it stays until the new one is complete.
std::optional<std::uint64_t> room_for(const std::filesystem::path& file);

/// Throws Error{output} where a file of so many bytes would not fit into `room`, of room_for().
void expect_room(const std::filesystem::path& file, double bytes, std::optional<std::uint64_t> room);

/// The bytes of a file. Errors: input; limit when memory runs out.
std::string read_text(const std::filesystem::path& path);
/// Writes bytes as they are; the file appears whole or not at all. Errors: output.
void write_text(const std::filesystem::path& path, std::string_view text, Existing existing = Existing::replace);

/// A file in the system's temporary folder, readable by its owner alone. The destructor removes it, and
/// remove_unfinished_files() does where a signal ends the program.
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

/// Removes a folder with all that is in it, as far as that can be done; no link is followed. Async-signal-safe.
void remove_folder(const char* name) noexcept;

/// Takes note that the file `file` (an open descriptor, or a folder's) is about to get the name `target`, its last
/// step.
void note_finishing(const std::filesystem::path& target, int file) noexcept;

/// Takes note that what was finished so far is not what a user waits for.
void forget_finished() noexcept;

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

// Bytes may wait on the disk until it is known where they go.

/// A file without a name: nothing of it is left, however the process ends. Every member throws Error{output}.
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
