// SPDX-License-Identifier: Apache-2.0
// The archive that a .3mf file is: its parts, and which of them is the model. Open Packaging Conventions, ECMA-376-2.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "files/file_view.h"
#include "files/zip.h"

namespace standoff {

/// Parts are unpacked when they are asked for, once, and kept. Errors everywhere: input; limit, where the parts that
/// were asked for unpack to more than a packed file of this size may hold.
class ThreemfPackage {
 public:
  /// The file must outlive it.
  explicit ThreemfPackage(const FileView& file);

  /// The bytes of a part, under the name FILE:PART. Names differ in more than the case of letters; a slash in front
  /// means nothing.
  const FileView& part(std::string_view name);
  /// The part that the package names as its 3D model. Encrypted packages are refused.
  const FileView& model();
  /// Bytes of all parts that were asked for.
  std::uint64_t unpacked() const { return unpacked_; }

 private:
  struct Entry {
    ZipMember member;
    std::unique_ptr<ZipMemberStream> stream;  // owns the bytes, where they were packed
    std::unique_ptr<FileView> part;
  };

  Entry* find(std::string_view name);
  const FileView& unpack(Entry& entry);

  const FileView& file_;
  std::map<std::string, Entry> entries_;  // by their names in lower case
  std::uint64_t unpacked_ = 0;
};

}  // namespace standoff
