// SPDX-License-Identifier: Apache-2.0
// Output folders that appear whole or not at all; what a folder holds.
#pragma once

#include <filesystem>
#include <functional>

#include "standoff/existing.h"

namespace standoff {

class ProgressMeter;

/// Whether a folder can be read, and `holds` is true of the name of each entry, and of whether that is a folder itself,
/// not a link to one. Ends at the first entry of which it is not. (The iterators of std::filesystem end the process
/// where memory runs out.)
bool all_entries(const std::filesystem::path& folder,
                 const std::function<bool(const char* name, bool is_folder)>& holds);

/// A folder of files that is made beside the target, as `.standoff-*.part`, and takes its place on commit. Without a
/// commit the target stays as it was, and the destructor, or remove_unfinished_files() where a signal ends the program,
/// removes what is unfinished; a killed process leaves it. Every member throws Error{output} as `FOLDER: what; what to
/// do`.
class AtomicFolder {
 public:
  /// Says whether an existing folder may be replaced, which removes it with all that is in it.
  using MayReplace = bool (*)(const std::filesystem::path&);

  /// Makes the unfinished folder. Refuses files in the place of the target, missing parents, and a folder that is
  /// there: with Existing::keep any, else those that are not empty and may not be replaced. `kind`, "a Zarr store of
  /// standoff", stands in the message.
  AtomicFolder(const std::filesystem::path& target, Existing existing, MayReplace may_replace, const char* kind);
  AtomicFolder(const AtomicFolder&) = delete;
  AtomicFolder& operator=(const AtomicFolder&) = delete;
  ~AtomicFolder();

  /// Where to write meanwhile.
  const std::filesystem::path& path() const { return unfinished_; }
  /// The target as the caller gave it, for messages.
  const std::filesystem::path& target() const { return shown_; }
  /// Waits until all is on the disk, and puts the folder in the target's place.
  void commit();

 private:
  void check_target() const;
  void sync() const;
  void take_name();
  void swap_with_target();
  void discard() noexcept;
  [[noreturn]] void fail(int error) const;

  std::filesystem::path shown_;   // the target as the caller wrote it, for messages
  std::filesystem::path target_;  // absolute, links followed
  std::filesystem::path unfinished_;
  Existing existing_;
  MayReplace may_replace_;
  const char* kind_;
  int slot_ = -1;  // in the table of unfinished files
};

}  // namespace standoff
