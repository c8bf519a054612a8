// SPDX-License-Identifier: Apache-2.0
// Zip archives, written front to back. Layout: PKWARE APPNOTE 6.3.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "files/atomic_file.h"

namespace standoff {

/// Members are written one after the other: begin, any number of writes, end; or begin_deflated, the deflated bytes,
/// end_deflated. Sizes past `zip64_from` are spelt in 64
/// bits; readers want that only from 4 GiB on, tests set it lower.
class ZipWriter {
 public:
  static constexpr std::uint64_t kZip64From = 0xFFFFFFFF;
  explicit ZipWriter(AtomicFile& file, std::uint64_t zip64_from = kZip64From) : file_(file), zip64_from_(zip64_from) {}

  /// Starts a member of exactly `bytes` bytes.
  void begin(const std::string& name, std::uint64_t bytes);
  void write(std::span<const std::byte> bytes);
  void end();
  /// Starts a member that unpacks to exactly `bytes` bytes.
  void begin_deflated(const std::string& name, std::uint64_t bytes);
  void write_deflated(std::string_view bytes) { file_.write(bytes.data(), bytes.size()); }
  /// With the checksum of what was deflated.
  void end_deflated(std::uint32_t crc);
  /// Writes the directory; the archive is complete, but not committed.
  void finish();

 private:
  struct Member {
    std::string name;
    std::uint64_t bytes = 0, packed = 0, header = 0;
    std::uint32_t crc = 0;
    bool deflated = false;
  };
  void begin(const Member& member);
  void write_text(const std::string& text) { file_.write(text.data(), text.size()); }

  AtomicFile& file_;
  std::uint64_t zip64_from_;
  std::vector<Member> members_;
};

}  // namespace standoff
