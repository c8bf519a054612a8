// SPDX-License-Identifier: Apache-2.0
#include "files/zip_reader.h"

#include <zlib.h>

#include <algorithm>
#include <cstring>

#include "files/shown.h"
#include "files/zip_format.h"

namespace standoff {
namespace {

// Little endian numbers at places of a record that is known to be long enough.
template <class Number>
Number number_at(std::string_view bytes, std::uint64_t offset) {
  Number number;
  std::memcpy(&number, bytes.data() + offset, sizeof number);
  return number;
}
std::uint16_t u16(std::string_view bytes, std::uint64_t offset) { return number_at<std::uint16_t>(bytes, offset); }
std::uint32_t u32(std::string_view bytes, std::uint64_t offset) { return number_at<std::uint32_t>(bytes, offset); }
std::uint64_t u64(std::string_view bytes, std::uint64_t offset) { return number_at<std::uint64_t>(bytes, offset); }

std::string_view record(const FileView& file, std::uint64_t offset, std::uint64_t bytes) {
  file.require(offset, bytes, "a record of the archive");
  return file.text(offset, bytes);
}

struct Directory {
  std::uint64_t offset = 0, bytes = 0, count = 0;
};

Directory find_directory(const FileView& file) {
  // The end record is last, but for a comment of at most 65535 bytes.
  const std::uint64_t tail_bytes = std::min<std::uint64_t>(file.size(), zip::kDirectoryEndBytes + 0xFFFF);
  const std::string_view tail = file.text(file.size() - tail_bytes, tail_bytes);
  const auto end = tail.rfind("PK\x05\x06");
  if (end == std::string::npos || tail.size() - end < zip::kDirectoryEndBytes)
    file.fail("directory", "it is missing; the file is truncated or no zip archive, write it again");
  Directory found{u32(tail, end + 16), u32(tail, end + 12), u16(tail, end + 10)};
  if (found.offset != zip::kIn64 && found.bytes != zip::kIn64 && found.count != zip::kCountIn64) return found;
  if (end < zip::kLocator64Bytes || u32(tail, end - zip::kLocator64Bytes) != zip::kLocator64)
    file.fail("directory", "its 64-bit part is missing; the file is damaged, write it again");
  const std::string_view end64 = record(file, u64(tail, end - zip::kLocator64Bytes + 8), zip::kDirectoryEnd64Bytes);
  if (u32(end64, 0) != zip::kDirectoryEnd64) file.fail("directory", "its 64-bit part is damaged; write the file again");
  return {u64(end64, 48), u64(end64, 40), u64(end64, 32)};
}

// Replaces sizes and offset that stand in the extra field.
void widen(const FileView& file, std::string_view extra, ZipMember& member, std::uint64_t& header) {
  for (std::uint64_t at = 0; extra.size() - at >= 4;) {
    const std::uint64_t length = u16(extra, at + 2), next = at + 4 + length;
    if (next > extra.size()) break;
    if (u16(extra, at) != zip::kExtra64) {
      at = next;
      continue;
    }
    at += 4;
    for (std::uint64_t* value : {&member.bytes, &member.packed, &header}) {
      if (*value != zip::kIn64) continue;
      if (next - at < 8) file.fail(shown(member.name), "its 64-bit sizes are damaged; write the file again");
      *value = u64(extra, at);
      at += 8;
    }
    return;
  }
}

// Local headers repeat the directory, but their extra fields may have another length.
std::uint64_t data_offset(const FileView& file, const std::string& name, std::uint64_t header) {
  const std::string_view local = record(file, header, zip::kLocalHeaderBytes);
  if (u32(local, 0) != zip::kLocalHeader) file.fail(shown(name), "its header is damaged; write the file again");
  return header + zip::kLocalHeaderBytes + u16(local, 26) + u16(local, 28);
}

}  // namespace

std::vector<ZipMember> read_zip(const FileView& file) {
  const Directory directory = find_directory(file);
  file.require(directory.offset, directory.bytes, "the archive's directory");
  std::vector<ZipMember> members;
  std::uint64_t at = directory.offset;
  for (std::uint64_t n = 0; n < directory.count; ++n) {
    const std::string_view fixed = record(file, at, zip::kDirectoryHeaderBytes);
    if (u32(fixed, 0) != zip::kDirectoryHeader)
      file.fail("directory", "entry " + std::to_string(n + 1) + " is damaged; write the file again");
    const std::uint64_t name_bytes = u16(fixed, 28), extra_bytes = u16(fixed, 30), comment_bytes = u16(fixed, 32);
    const std::string_view rest = record(file, at + zip::kDirectoryHeaderBytes, name_bytes + extra_bytes);
    at += zip::kDirectoryHeaderBytes + name_bytes + extra_bytes + comment_bytes;

    constexpr std::uint16_t kEncrypted = 1;
    ZipMember member{std::string(rest.substr(0, name_bytes)), 0, u32(fixed, 20), u32(fixed, 24), u32(fixed, 16)};
    std::uint64_t header = u32(fixed, 42);
    widen(file, rest.substr(name_bytes), member, header);
    if (u16(fixed, 8) & kEncrypted) file.fail(shown(member.name), "it is encrypted; save it without a password");
    const std::uint16_t method = u16(fixed, 10);
    if (method != kStored && method != kDeflated)
      file.fail(shown(member.name), "it is packed by method " + std::to_string(method) +
                                        ", which is not read; write it again, deflated or not packed at all");
    member.deflated = method == kDeflated;
    const bool possible =
        member.deflated ? member.bytes / kMostDeflated <= member.packed : member.packed == member.bytes;
    if (!possible) file.fail(shown(member.name), "its sizes contradict each other; write the file again");
    member.offset = data_offset(file, member.name, header);
    file.require(member.offset, member.packed, "a member");
    members.push_back(std::move(member));
  }
  return members;
}

ZipMemberStream::ZipMemberStream(const FileView& file, const ZipMember& member) : file_(file), member_(member) {
  if (member.deflated)
    inflater_.emplace(file, shown(member.name), file.text(member.offset, member.packed), Inflater::Wrapper::none);
}

std::string_view ZipMemberStream::next(std::uint64_t bytes) {
  if (bytes > member_.bytes - done_) fail("it is shorter than its content says; the file is damaged, write it again");
  std::string_view part = file_.text(member_.offset + done_, bytes);
  if (inflater_) {
    char* const to = buffer_.room(bytes);
    inflater_->fill(to, bytes);
    part = {to, bytes};
  }
  done_ += bytes;
  if (bytes > 0)  // zlib takes no bytes for a new beginning
    crc_ = static_cast<std::uint32_t>(::crc32_z(crc_, reinterpret_cast<const Bytef*>(part.data()), part.size()));
  if (done_ == member_.bytes && crc_ != member_.crc) fail("its checksum is wrong; the file is damaged, write it again");
  return part;
}

void ZipMemberStream::finish() {
  constexpr std::uint64_t kPart = std::uint64_t{1} << 20;
  do next(std::min(kPart, member_.bytes - done_));
  while (done_ < member_.bytes);
}

void ZipMemberStream::fail(const char* what) const { file_.fail(shown(member_.name), what); }

}  // namespace standoff
