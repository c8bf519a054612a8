// SPDX-License-Identifier: Apache-2.0
#include "io/zarr/shard.h"

#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "core/field_error.h"
#include "io/zarr/blosc.h"

namespace standoff::zarr {
namespace {

// Table t: what a byte becomes that t others follow, so that eight bytes are taken at once.
using CrcTables = std::array<std::array<std::uint32_t, 256>, 8>;
constexpr CrcTables make_crc_tables() {
  constexpr std::uint32_t kPolynomial = 0x82f63b78;  // bits reversed
  CrcTables tables{};
  for (std::uint32_t n = 0; n < 256; ++n) {
    std::uint32_t crc = n;
    for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ (crc & 1 ? kPolynomial : 0);
    tables[0][n] = crc;
  }
  for (std::size_t t = 1; t < tables.size(); ++t)
    for (std::size_t n = 0; n < 256; ++n) tables[t][n] = tables[t - 1][n] >> 8 ^ tables[0][tables[t - 1][n] & 0xff];
  return tables;
}
constexpr CrcTables kCrc = make_crc_tables();

constexpr const char* kWriteAgain = "; the file is damaged, write the store again";

}  // namespace

std::uint32_t crc32c(std::span<const std::byte> bytes) {
  std::uint32_t crc = ~std::uint32_t{0};
  for (; bytes.size() >= 8; bytes = bytes.subspan(8)) {
    std::array<std::uint32_t, 2> words;
    std::memcpy(words.data(), bytes.data(), sizeof words);
    const std::uint32_t a = words[0] ^ crc, b = words[1];
    crc = kCrc[7][a & 0xff] ^ kCrc[6][a >> 8 & 0xff] ^ kCrc[5][a >> 16 & 0xff] ^ kCrc[4][a >> 24] ^ kCrc[3][b & 0xff] ^
          kCrc[2][b >> 8 & 0xff] ^ kCrc[1][b >> 16 & 0xff] ^ kCrc[0][b >> 24];
  }
  for (const std::byte byte : bytes) crc = crc >> 8 ^ kCrc[0][(crc ^ static_cast<std::uint32_t>(byte)) & 0xff];
  return ~crc;
}

std::vector<std::byte> ShardIndex::bytes() const {
  static_assert(sizeof(Entry) == 16);
  std::vector<std::byte> bytes(size_of(chunks_));
  const std::size_t entries = bytes.size() - sizeof(std::uint32_t);
  std::memcpy(bytes.data(), entries_.data(), entries);
  const std::uint32_t crc = crc32c(std::span(bytes).first(entries));
  std::memcpy(bytes.data() + entries, &crc, sizeof crc);
  return bytes;
}

bool ShardIndex::read(std::span<const std::byte> bytes) {
  const std::size_t entries = bytes.size() - sizeof(std::uint32_t);
  std::memcpy(entries_.data(), bytes.data(), entries);
  std::uint32_t crc;
  std::memcpy(&crc, bytes.data() + entries, sizeof crc);
  return crc == crc32c(bytes.first(entries));
}

StoredShard::StoredShard(const StoredLayout& layout, const Size3& at)
    : layout_(&layout), path_(layout.folder / layout.file_name(at)) {
  if (!layout.sharded) {
    there_ = ::access(path_.c_str(), F_OK) == 0 || errno != ENOENT;
    return;
  }
  file_ = open();
  there_ = file_.number() >= 0;
  if (there_) read_index();
}

Descriptor StoredShard::open() const { return open_stored(path_, "shards are"); }

std::uint64_t StoredShard::size_of(const Descriptor& file) const {
  struct stat about {};
  if (::fstat(file.number(), &about) != 0) fail("", cannot_read(errno));
  return static_cast<std::uint64_t>(about.st_size);
}

void StoredShard::read_index() {
  index_ = ShardIndex(layout_->chunks());
  std::vector<std::byte> bytes(ShardIndex::size_of(layout_->chunks()));
  const std::uint64_t size = size_of(file_);
  if (size < bytes.size())
    fail("index", "the file has " + std::to_string(size) + " bytes, where its index alone has " +
                      std::to_string(bytes.size()) + kWriteAgain);
  read_bytes(file_, layout_->index_first ? 0 : size - bytes.size(), bytes);
  if (!index_.read(bytes)) fail("index", std::string("its checksum is wrong") + kWriteAgain);
}

void StoredShard::read(const Size3& chunk, std::span<std::byte> out, UnpackedBytes& packed) const {
  const auto fail_chunk = [&](const std::string& what) {
    fail("chunk " + index_text(chunk.x, chunk.y, chunk.z), what.find("; ") == what.npos ? what + kWriteAgain : what);
  };
  const Descriptor alone = layout_->sharded ? Descriptor() : open();
  const Descriptor& file = layout_->sharded ? file_ : alone;
  if (file.number() < 0) fail("", "another program has removed it; give it time to end");
  const std::uint64_t size = size_of(file);
  const ShardIndex::Entry entry = layout_->sharded ? index_[chunk] : ShardIndex::Entry{0, size};
  if (entry.offset > size || entry.bytes > size - entry.offset) fail_chunk("it reaches past the end of the file");
  const std::uint64_t of_sum = layout_->checked ? kSumBytes : 0, content = entry.bytes - of_sum;
  if (entry.bytes < of_sum || (layout_->blosc ? content > blosc_most(out.size()) : content != out.size()))
    fail_chunk("it has " + std::to_string(entry.bytes) + " bytes, where " + std::to_string(out.size() + of_sum) +
               (layout_->blosc ? " unpacked ones never become so many" : " are needed"));
  if (layout_->blosc && !have_blosc())
    fail("", std::string("its chunks are compressed by blosc, and ") + kWithoutBlosc);
  std::span<std::byte> bytes = out;
  if (layout_->blosc) bytes = {reinterpret_cast<std::byte*>(packed.room(blosc_most(out.size()))), content};
  read_bytes(file, entry.offset, bytes);
  if (layout_->checked) {
    std::uint32_t sum = 0;
    read_bytes(file, entry.offset + content, std::as_writable_bytes(std::span(&sum, 1)));
    if (sum != crc32c(bytes)) fail_chunk("its checksum is wrong");
  }
  if (!layout_->blosc) return;
  if (const std::string wrong = blosc_unpack({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, out);
      !wrong.empty())
    fail_chunk(wrong);
}

void StoredShard::read_bytes(const Descriptor& file, std::uint64_t offset, std::span<std::byte> out) const {
  while (!out.empty()) {
    const auto got = ::pread(file.number(), out.data(), out.size(), static_cast<off_t>(offset));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) fail("", cannot_read(errno));
    if (got == 0) fail("", "another program is shortening it; give it time to end");
    offset += static_cast<std::uint64_t>(got);
    out = out.subspan(static_cast<std::size_t>(got));
  }
}

void StoredShard::fail(const std::string& where, const std::string& what) const {
  FileView(path_, std::string_view()).fail(where, what);
}

}  // namespace standoff::zarr
