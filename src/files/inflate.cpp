// SPDX-License-Identifier: Apache-2.0
#include "files/inflate.h"

#include <zlib.h>

#include <algorithm>
#include <cstring>
#include <new>
#include <utility>

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

}  // namespace standoff
