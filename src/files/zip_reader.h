// SPDX-License-Identifier: Apache-2.0
// Zip archives, read: their directory, and their members front to back. Layout: PKWARE APPNOTE 6.3.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "files/byte_stream.h"
#include "files/file_view.h"
#include "files/inflate.h"

namespace standoff {

struct ZipMember {
  std::string name;
  std::uint64_t offset = 0;  ///< of its first byte in the archive
  std::uint64_t packed = 0;  ///< bytes there
  std::uint64_t bytes = 0;   ///< once unpacked; no more than packed ones can become
  std::uint32_t crc = 0;     ///< of the unpacked bytes
  bool deflated = false;     ///< as they are otherwise
};

/// The members of an archive, each of them within the file. Errors: input, also for archives that are encrypted, split
/// or packed by other means than deflate.
std::vector<ZipMember> read_zip(const FileView& file);

/// A member's bytes, checked against its checksum once all of them are read.
class ZipMemberStream : public ByteStream {
 public:
  /// All must outlive it.
  ZipMemberStream(const FileView& file, const ZipMember& member);

  /// Memory for the bytes is taken only where they are packed.
  std::string_view next(std::uint64_t bytes) override;
  void finish() override;

 private:
  [[noreturn]] void fail(const char* what) const;

  const FileView& file_;
  const ZipMember& member_;
  std::optional<Inflater> inflater_;
  UnpackedBytes buffer_;
  std::uint64_t done_ = 0;
  std::uint32_t crc_ = 0;
};

}  // namespace standoff
