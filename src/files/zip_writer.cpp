// SPDX-License-Identifier: Apache-2.0
#include "files/zip_writer.h"

#include <zlib.h>

#include "files/zip_format.h"

namespace standoff {
namespace {

// Little endian numbers, one after the other.
struct ZipRecord {
  std::string bytes;

  ZipRecord& u16(std::uint64_t value) { return add(value, 2); }
  ZipRecord& u32(std::uint64_t value) { return add(value, 4); }
  ZipRecord& u64(std::uint64_t value) { return add(value, 8); }
  ZipRecord& text(const std::string& value) {
    bytes += value;
    return *this;
  }

 private:
  ZipRecord& add(std::uint64_t value, int count) {
    for (; count > 0; --count, value >>= 8) bytes += static_cast<char>(value & 0xFF);
    return *this;
  }
};

constexpr std::uint16_t kZipVersion = 20, kZipVersion64 = 45;  // what a reader must understand
constexpr std::uint16_t kStored = 0, kDeflated = 8;
constexpr std::uint32_t kDate = 0x21, kTime = 0;  // 1980-01-01: equal fields make equal files
constexpr std::uint32_t kRegularFile = 0100644u << 16;
constexpr std::uint16_t kMadeOnUnix = 3 << 8;

}  // namespace

void ZipWriter::begin(const std::string& name, std::uint64_t bytes) {
  begin({name, bytes, bytes, file_.size(), 0, false});
}

// What is deflated may become a little longer.
void ZipWriter::begin_deflated(const std::string& name, std::uint64_t bytes) {
  begin({name, bytes, bytes + bytes / 1000 + 1024, file_.size(), 0, true});
}

void ZipWriter::begin(const Member& member) {
  members_.push_back(member);
  const bool wide = member.packed >= zip64_from_;
  ZipRecord record;
  record.u32(zip::kLocalHeader).u16(wide ? kZipVersion64 : kZipVersion).u16(0);
  record.u16(member.deflated ? kDeflated : kStored).u16(kTime).u16(kDate);
  record.u32(0);  // the checksum, once it is known
  record.u32(wide ? zip::kIn64 : member.packed).u32(wide ? zip::kIn64 : member.bytes);
  record.u16(member.name.size()).u16(wide ? 20 : 0).text(member.name);
  if (wide) record.u16(zip::kExtra64).u16(16).u64(member.bytes).u64(member.packed);
  write_text(record.bytes);
}

void ZipWriter::end_deflated(std::uint32_t crc) {
  Member& member = members_.back();
  const bool wide = member.packed >= zip64_from_;
  const std::uint64_t names = member.header + zip::kLocalHeaderBytes + member.name.size();
  member.packed = file_.size() - names - (wide ? 20 : 0);
  member.crc = crc;
  const ZipRecord record = ZipRecord().u32(crc).u32(wide ? zip::kIn64 : member.packed);
  file_.overwrite(member.header + zip::kLocalCrcOffset, record.bytes.data(), record.bytes.size());
  if (!wide) return;
  const ZipRecord packed = ZipRecord().u64(member.packed);
  file_.overwrite(names + 12, packed.bytes.data(), packed.bytes.size());  // the last part of the extra field
}

void ZipWriter::write(std::span<const std::byte> bytes) {
  if (bytes.empty()) return;  // which zlib takes for a new beginning
  std::uint32_t& crc = members_.back().crc;
  crc = static_cast<std::uint32_t>(::crc32_z(crc, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size()));
  file_.write(bytes.data(), bytes.size());
}

void ZipWriter::end() {
  const Member& member = members_.back();
  const ZipRecord record = ZipRecord().u32(member.crc);
  file_.overwrite(member.header + zip::kLocalCrcOffset, record.bytes.data(), record.bytes.size());
}

void ZipWriter::finish() {
  const std::uint64_t start = file_.size();
  bool any_wide = false;
  for (const Member& member : members_) {
    const bool wide = member.bytes >= zip64_from_ || member.packed >= zip64_from_ || member.header >= zip64_from_;
    any_wide |= wide;
    ZipRecord record;
    record.u32(zip::kDirectoryHeader).u16(kMadeOnUnix | (wide ? kZipVersion64 : kZipVersion));
    record.u16(wide ? kZipVersion64 : kZipVersion).u16(0);
    record.u16(member.deflated ? kDeflated : kStored).u16(kTime).u16(kDate).u32(member.crc);
    record.u32(wide ? zip::kIn64 : member.packed)
        .u32(wide ? zip::kIn64 : member.bytes)
        .u16(member.name.size())
        .u16(wide ? 28 : 0)
        .u16(0)
        .u16(0)
        .u16(0)
        .u32(kRegularFile);
    record.u32(wide ? zip::kIn64 : member.header).text(member.name);
    if (wide) record.u16(zip::kExtra64).u16(24).u64(member.bytes).u64(member.packed).u64(member.header);
    write_text(record.bytes);
  }
  const std::uint64_t end = file_.size(), count = members_.size();
  const bool wide = any_wide || start >= zip64_from_;
  ZipRecord record;
  if (wide) {
    record.u32(zip::kDirectoryEnd64)
        .u64(zip::kDirectoryEnd64Bytes - 12)
        .u16(kMadeOnUnix | kZipVersion64)
        .u16(kZipVersion64);
    record.u32(0).u32(0).u64(count).u64(count).u64(end - start).u64(start);
    record.u32(zip::kLocator64).u32(0).u64(end).u32(1);
  }
  record.u32(zip::kDirectoryEnd).u16(0).u16(0).u16(count).u16(count).u32(end - start);
  record.u32(wide ? zip::kIn64 : start).u16(0);
  write_text(record.bytes);
}

}  // namespace standoff
