// SPDX-License-Identifier: Apache-2.0
#include "files/zip.h"

#include <zlib.h>

#include <algorithm>
#include <cstring>
#include <new>
#include <utility>

#include "files/checksums.h"
#include "standoff/error.h"

namespace standoff {
namespace {

// zlib counts in 32 bits. Between parts that are made, the caller may stop.
constexpr std::size_t kMostFed = std::size_t{1} << 30, kMostMadeAtOnce = std::size_t{1} << 20;

[[noreturn]] void fail_for_size(const FileView& file, std::uint64_t most) {
  throw Error(ErrorCode::limit, file.path().string() + ": it unpacks to more than " + std::to_string(most >> 20) +
                                    " MiB, where a file of its size may have no more; if it is meant, unpack it "
                                    "(gunzip) and read what comes out");
}

}  // namespace

struct Inflater::State {
  z_stream stream{};
};

Inflater::Inflater(const FileView& file, std::string where, std::string_view packed, Wrapper wrapper)
    : file_(file), where_(std::move(where)), left_(packed), wrapper_(wrapper), state_(std::make_unique<State>()) {
  constexpr int kGzip = 16;  // added to the size of the window it asks for gzip's headers
  const int window = wrapper == Wrapper::gzip ? MAX_WBITS + kGzip : wrapper == Wrapper::zlib ? MAX_WBITS : -MAX_WBITS;
  if (::inflateInit2(&state_->stream, window) != Z_OK) throw std::bad_alloc();
}

Inflater::~Inflater() { ::inflateEnd(&state_->stream); }

std::size_t Inflater::read(char* to, std::size_t room) {
  z_stream& stream = state_->stream;
  std::size_t done = 0;
  while (done < room && !ended_) {
    file_.check();
    if (stream.avail_in == 0) {
      const std::size_t part = std::min(left_.size(), kMostFed);
      stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(left_.data()));  // zlib does not write there
      stream.avail_in = static_cast<uInt>(part);
      left_.remove_prefix(part);
    }
    const std::size_t part = std::min(room - done, kMostMadeAtOnce);
    stream.next_out = reinterpret_cast<Bytef*>(to + done);
    stream.avail_out = static_cast<uInt>(part);
    const int result = ::inflate(&stream, Z_NO_FLUSH);
    done += part - stream.avail_out;
    if (result == Z_STREAM_END) {
      ended_ = !begin_next_stream();
    } else if (result == Z_MEM_ERROR) {
      throw std::bad_alloc();
    } else if (result == Z_BUF_ERROR && left_.empty()) {
      fail("its packed bytes are cut off; get all of the file");
    } else if (result != Z_OK) {
      fail("its packed bytes are damaged; get the file again");
    }
  }
  return done;
}

// gzip files may be joined by writing one after the other. What follows and is no gzip, such as padding, is not looked
// at, as gunzip does.
bool Inflater::begin_next_stream() {
  if (wrapper_ != Wrapper::gzip) return false;
  z_stream& stream = state_->stream;
  const std::string_view rest(left_.data() - stream.avail_in, left_.size() + stream.avail_in);
  if (!is_gzip(rest)) return false;
  left_ = rest;
  stream.avail_in = 0;
  return ::inflateReset(&stream) == Z_OK;
}

void Inflater::fail(const char* what) const { file_.fail(where_, what); }

void Inflater::fill(char* to, std::size_t room) {
  if (read(to, room) != room) fail("it unpacks to fewer bytes than promised; the file is damaged, write it again");
}

std::string_view GzipStream::next(std::uint64_t bytes) {
  char* const to = buffer_.room(bytes);
  inflater_.fill(to, bytes);
  return {to, bytes};
}

void GzipStream::finish() {
  constexpr std::size_t kPart = std::size_t{1} << 16;
  char* const to = buffer_.room(kPart);
  while (inflater_.read(to, kPart) == kPart) {
  }
}

bool is_gzip(std::string_view content) { return content.starts_with("\x1f\x8b\x08"); }

std::unique_ptr<FileView> unpack_gzip(const FileView& file) {
  constexpr std::size_t kLeast = std::size_t{1} << 16;
  const std::uint64_t most = most_unpacked(file.size());
  Inflater inflater(file, "", file.bytes(), Inflater::Wrapper::gzip);
  // The last four bytes are the size, where there is one stream below 4 GiB and nothing behind it. One byte more, so
  // that the end is found without a larger buffer.
  constexpr std::uint64_t kSize = 4;
  const std::uint64_t said = file.size() < kSize ? 0 : file.number<std::uint32_t>(file.size() - kSize);
  std::size_t room = std::max(kLeast, said <= most ? said + 1 : 0), size = 0;
  auto bytes = std::make_unique_for_overwrite<char[]>(room);
  while ((size += inflater.read(bytes.get() + size, room - size)) == room && size <= most) {
    const std::size_t more = std::min(2 * room, most + 1);
    auto larger = std::make_unique_for_overwrite<char[]>(more);
    std::memcpy(larger.get(), bytes.get(), size);
    bytes = std::move(larger);
    room = more;
  }
  if (size > most) fail_for_size(file, most);
  return std::make_unique<FileView>(file, std::move(bytes), size);
}

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
  std::uint32_t& crc = members_.back().crc;
  crc = crc32_of(crc, bytes);
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
  crc_ = crc32_of(crc_, std::as_bytes(std::span(part)));
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
