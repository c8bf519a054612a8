// SPDX-License-Identifier: Apache-2.0
#include "tests/grammar/packed.h"

#include <zlib.h>

#include "files/zip.h"
#include "tests/grammar/hostile.h"

namespace standoff::grammar {
namespace {

std::string packed(Choices& c, const std::string& content, int window) {
  constexpr int kStrategies[] = {Z_DEFAULT_STRATEGY, Z_FILTERED, Z_HUFFMAN_ONLY, Z_RLE, Z_FIXED};
  z_stream stream{};
  ::deflateInit2(&stream, static_cast<int>(c.below(10)), Z_DEFLATED, window, 8, c.pick(kStrategies));
  std::string bytes(::deflateBound(&stream, content.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(content.data()));
  stream.avail_in = static_cast<uInt>(content.size());
  stream.next_out = reinterpret_cast<Bytef*>(bytes.data());
  stream.avail_out = static_cast<uInt>(bytes.size());
  ::deflate(&stream, Z_FINISH);
  bytes.resize(stream.total_out);
  ::deflateEnd(&stream);
  damage(c, bytes);
  return bytes;
}

constexpr int kGzip = 16;  // added to the window: with gzip's header and checksum

}  // namespace

std::string deflated(Choices& c, const std::string& content) { return packed(c, content, -MAX_WBITS); }

std::string zlibbed(Choices& c, const std::string& content) { return packed(c, content, MAX_WBITS); }

std::string gzipped(Choices& c, const std::string& content) {
  if (c.trick()) return packed(c, content + std::string(std::size_t{100} * c.many(), '\0'), MAX_WBITS + kGzip);
  const std::size_t cut = c.one_in(3) ? c.below(static_cast<std::uint32_t>(content.size()) + 1) : content.size();
  std::string bytes = packed(c, content.substr(0, cut), MAX_WBITS + kGzip);
  if (cut < content.size()) bytes += packed(c, content.substr(cut), MAX_WBITS + kGzip);
  if (c.one_in(6)) bytes += std::string(c.below(600), '\0');  // padding of a tape
  return bytes;
}

namespace {

struct Entry {
  std::string name, extra, comment;
  std::uint16_t flags, method;
  std::uint32_t crc, stored_bytes, bytes, offset;
};

class Archive {
 public:
  explicit Archive(Choices& c) : c_(c) {}

  void add(const std::string& name, const std::string& content) {
    if (c_.one_in(12)) bytes_ += "between";
    constexpr std::uint16_t kDescriptor = 8, kEncrypted = 1, kDeflated = 8;
    const bool descriptor = c_.one_in(5);
    Entry entry{word(c_, name), "", "", 0, 0, 0, 0, 0, 0};
    entry.flags = descriptor ? kDescriptor : 0;
    if (c_.trick()) entry.flags |= kEncrypted;
    const bool packed = c_.one_in(3);
    entry.method = stored(c_, packed ? kDeflated : std::uint16_t{0});
    const std::string body = packed ? deflated(c_, content) : content;
    entry.crc = stored(
        c_, static_cast<std::uint32_t>(::crc32_z(0, reinterpret_cast<const Bytef*>(content.data()), content.size())));
    entry.bytes = stored(c_, static_cast<std::uint32_t>(content.size()));
    entry.stored_bytes = stored(c_, static_cast<std::uint32_t>(body.size()));
    // A member may begin where another one does.
    entry.offset = !entries_.empty() && c_.trick() ? entries_.back().offset : static_cast<std::uint32_t>(bytes_.size());
    const std::string local_extra = c_.one_in(6) ? extra() : "";
    const std::uint32_t said[] = {descriptor ? 0 : entry.crc, descriptor ? 0 : entry.stored_bytes,
                                  descriptor ? 0 : entry.bytes};
    bytes_ += raw(stored(c_, zip::kLocalHeader)) + raw(std::uint16_t{20}) + raw(entry.flags) + raw(entry.method) +
              raw(std::uint32_t{0x00210000}) + raw(said[0]) + raw(said[1]) + raw(said[2]) +
              raw(stored(c_, static_cast<std::uint16_t>(entry.name.size()))) +
              raw(stored(c_, static_cast<std::uint16_t>(local_extra.size()))) + entry.name + local_extra + body;
    if (descriptor)
      bytes_ += raw(std::uint32_t{0x08074b50}) + raw(entry.crc) + raw(entry.stored_bytes) + raw(entry.bytes);
    entry.extra = c_.one_in(6) ? extra() : "";
    entry.comment = c_.one_in(8) ? "remark" : "";
    if (c_.one_in(6)) widen(entry);
    entries_.push_back(entry);
    if (c_.trick()) entries_.push_back(entry);
  }

  std::string finish() {
    const std::size_t begin = bytes_.size();
    if (c_.trick())
      for (std::uint32_t n = c_.many(); n > 0 && !entries_.empty(); --n) entries_.push_back(entries_[0]);
    for (const Entry& entry : entries_) put_entry(entry);
    const std::size_t size = bytes_.size() - begin;
    auto count = static_cast<std::uint16_t>(entries_.size()), in64 = zip::kCountIn64;
    const bool wide = c_.one_in(5);
    if (wide) put_end64(begin, size);
    const std::string comment = c_.one_in(4) ? "remark" : "";
    bytes_ += raw(stored(c_, zip::kDirectoryEnd)) + raw(std::uint32_t{0}) + raw(stored(c_, wide ? in64 : count)) +
              raw(stored(c_, wide ? in64 : count)) +
              raw(stored(c_, wide ? zip::kIn64 : static_cast<std::uint32_t>(size))) +
              raw(stored(c_, wide ? zip::kIn64 : static_cast<std::uint32_t>(begin))) +
              raw(stored(c_, static_cast<std::uint16_t>(comment.size()))) + comment;
    return std::move(bytes_);
  }

 private:
  // An extra field that nobody knows.
  std::string extra() { return raw(std::uint16_t{0x7875}) + raw(stored(c_, std::uint16_t{5})) + "12345"; }

  // The sizes and the offset in the 64-bit field.
  void widen(Entry& entry) {
    const std::string numbers = raw(stored(c_, std::uint64_t{entry.bytes})) +
                                raw(stored(c_, std::uint64_t{entry.stored_bytes})) +
                                raw(stored(c_, std::uint64_t{entry.offset}));
    entry.extra += raw(zip::kExtra64) + raw(stored(c_, static_cast<std::uint16_t>(numbers.size()))) + numbers;
    entry.bytes = entry.stored_bytes = entry.offset = zip::kIn64;
  }

  void put_entry(const Entry& e) {
    bytes_ += raw(stored(c_, zip::kDirectoryHeader)) + raw(std::uint32_t{0x00140014}) + raw(e.flags) + raw(e.method) +
              raw(std::uint32_t{0x00210000}) + raw(e.crc) + raw(e.stored_bytes) + raw(e.bytes) +
              raw(stored(c_, static_cast<std::uint16_t>(e.name.size()))) +
              raw(stored(c_, static_cast<std::uint16_t>(e.extra.size()))) +
              raw(stored(c_, static_cast<std::uint16_t>(e.comment.size()))) + std::string(8, '\0') +
              raw(stored(c_, e.offset)) + e.name + e.extra + e.comment;
  }

  void put_end64(std::size_t begin, std::size_t size) {
    const std::uint64_t at = bytes_.size();
    bytes_ += raw(zip::kDirectoryEnd64) + raw(std::uint64_t{zip::kDirectoryEnd64Bytes - 12}) +
              raw(std::uint32_t{0x002d002d}) + std::string(8, '\0') + raw(stored(c_, std::uint64_t{entries_.size()})) +
              raw(stored(c_, std::uint64_t{entries_.size()})) + raw(stored(c_, std::uint64_t{size})) +
              raw(stored(c_, std::uint64_t{begin}));
    bytes_ += raw(zip::kLocator64) + raw(std::uint32_t{0}) + raw(stored(c_, at)) + raw(std::uint32_t{1});
  }

  Choices& c_;
  std::string bytes_;
  std::vector<Entry> entries_;
};

}  // namespace

std::string make_zip(Choices& c, const std::vector<std::pair<std::string, std::string>>& members) {
  Archive archive(c);
  for (const auto& [name, content] : members)
    if (!c.trick()) archive.add(name, content);
  return archive.finish();
}

}  // namespace standoff::grammar
