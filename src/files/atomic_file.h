// SPDX-License-Identifier: Apache-2.0
// Output files that appear whole or not at all, and whole text files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

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
  ProgressMeter* waiting_ = nullptr;
  std::unique_ptr<char[]> buffer_;
  std::size_t buffered_ = 0;
};

/// The bytes of a file. Errors: input; limit when memory runs out.
std::string read_text(const std::filesystem::path& path);
/// Writes bytes as they are; the file appears whole or not at all. Errors: output.
void write_text(const std::filesystem::path& path, std::string_view text, Existing existing = Existing::replace);

}  // namespace standoff
