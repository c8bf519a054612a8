// SPDX-License-Identifier: Apache-2.0
// Pictures that become a folder, all or none.
#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include "render/image.h"
#include "standoff/existing.h"

namespace standoff::view {

/// Pictures are written into an unfinished folder, `.standoff-*.part`: in the one that is there, or beside the one that
/// is to be. The destructor removes it.
class PictureFolder {
 public:
  /// For pictures numbered up to `count` - 1. Errors: as check_frames.
  PictureFolder(const std::filesystem::path& folder, std::size_t count, Existing existing);
  PictureFolder(const PictureFolder&) = delete;
  PictureFolder& operator=(const PictureFolder&) = delete;
  ~PictureFolder();

  /// Errors: output.
  void add(const Image& image);
  /// Puts the pictures where they belong. Errors: output.
  void commit();

 private:
  [[noreturn]] void fail(const std::error_code& why) const;
  void replace_old();

  std::filesystem::path shown_, folder_, unfinished_;
  std::vector<std::filesystem::path> names_;
  std::size_t digits_;
  Existing existing_;
  int slot_ = -1;  // in the table of unfinished files
};

}  // namespace standoff::view
