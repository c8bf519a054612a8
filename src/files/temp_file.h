// SPDX-License-Identifier: Apache-2.0
// A file for something that is given to others by name, such as a browser or a reader of meshes.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace standoff {

/// In the system's folder for such files, readable by its owner alone. Removed at the end, and where a signal ends the
/// program (files/temp_file_registry.h).
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

}  // namespace standoff
