// SPDX-License-Identifier: Apache-2.0
// Files of a store's array: shards, each with chunks and an index that says where they are; or a single chunk.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "files/file_view.h"
#include "io/zarr/metadata.h"

namespace standoff::zarr {

/// CRC-32C (Castagnoli; RFC 3720), which ends an index, and a chunk that is checked.
std::uint32_t crc32c(std::span<const std::byte> bytes);
inline constexpr std::uint64_t kSumBytes = sizeof(std::uint32_t);

/// Where the chunks of a shard are in its file: two numbers for each, z fastest; then a checksum. All are little
/// endian.
class ShardIndex {
 public:
  struct Entry {
    std::uint64_t offset = kNone, bytes = kNone;
    bool stored() const { return offset != kNone || bytes != kNone; }
  };

  ShardIndex() = default;
  /// Of a shard without chunks.
  explicit ShardIndex(const Size3& chunks) : chunks_(chunks), entries_(static_cast<std::size_t>(chunks.count())) {}

  Entry& operator[](const Size3& chunk) { return entries_[place(chunk)]; }
  const Entry& operator[](const Size3& chunk) const { return entries_[place(chunk)]; }

  /// As it stands in a file.
  std::vector<std::byte> bytes() const;
  /// The bytes of the index of so many chunks.
  static std::uint64_t size_of(const Size3& chunks) {
    return 16 * static_cast<std::uint64_t>(chunks.count()) + kSumBytes;
  }
  /// Takes the entries of size_of() bytes; false if the checksum is another.
  bool read(std::span<const std::byte> bytes);

 private:
  static constexpr std::uint64_t kNone = ~std::uint64_t{0};
  std::size_t place(const Size3& c) const {
    return static_cast<std::size_t>(c.z + chunks_.z * (c.y + chunks_.y * c.x));
  }

  Size3 chunks_;
  std::vector<Entry> entries_;
};

/// A file of an array, open to be read. What another process puts in its place meanwhile does not matter.
class StoredShard {
 public:
  /// Opens file number `at` and reads its index. A file that does not exist stores no chunk. Errors: input.
  StoredShard(const StoredLayout& layout, const Size3& at);

  /// Whether the file has that chunk of it.
  bool stored(const Size3& chunk) const { return there_ && (!layout_->sharded || index_[chunk].stored()); }
  /// Unpacks a stored chunk into chunk_bytes() bytes. `packed` is memory to use. Errors: input, that names the file and
  /// the chunk.
  void read(const Size3& chunk, std::span<std::byte> out, UnpackedBytes& packed) const;

 private:
  Descriptor open() const;
  std::uint64_t size_of(const Descriptor& file) const;
  void read_index();
  void read_bytes(const Descriptor& file, std::uint64_t offset, std::span<std::byte> out) const;
  [[noreturn]] void fail(const std::string& where, const std::string& what) const;

  const StoredLayout* layout_;
  std::filesystem::path path_;
  Descriptor file_;  // of a shard; a single chunk's is opened when it is read, for there may be very many
  bool there_ = false;
  ShardIndex index_;
};

}  // namespace standoff::zarr
