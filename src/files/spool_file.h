// SPDX-License-Identifier: Apache-2.0
// Bytes put aside on the disk until it is known where they go.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

#include "files/descriptor.h"

namespace standoff {

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
