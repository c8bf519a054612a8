// SPDX-License-Identifier: Apache-2.0
#include "files/deflate.h"

#include <zlib.h>

#include <algorithm>
#include <limits>
#include <new>
#include <stdexcept>

namespace standoff {
namespace {

// zlib counts what is left to read and to write in 32 bits.
constexpr std::size_t kMostAtOnce = std::size_t{1} << 30;
constexpr std::size_t kPiece = std::size_t{1} << 18;

struct DeflateStream {
  z_stream z{};
  explicit DeflateStream(int level) {
    const int begun = deflateInit(&z, level);
    if (begun == Z_MEM_ERROR) throw std::bad_alloc();
    if (begun != Z_OK) throw std::logic_error("deflateInit: " + std::to_string(begun));
  }
  DeflateStream(const DeflateStream&) = delete;
  DeflateStream& operator=(const DeflateStream&) = delete;
  ~DeflateStream() { deflateEnd(&z); }
};

}  // namespace

std::string zlib_packed(std::string_view bytes, int level) {
  DeflateStream stream(level);
  std::string packed;
  int state = Z_OK;
  while (state != Z_STREAM_END) {
    if (stream.z.avail_in == 0) {
      const std::string_view next = bytes.substr(0, kMostAtOnce);
      bytes.remove_prefix(next.size());
      stream.z.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(next.data()));
      stream.z.avail_in = static_cast<uInt>(next.size());
    }
    const std::size_t before = packed.size();
    packed.resize(before + kPiece);
    stream.z.next_out = reinterpret_cast<Bytef*>(packed.data() + before);
    stream.z.avail_out = static_cast<uInt>(kPiece);
    state = deflate(&stream.z, bytes.empty() ? Z_FINISH : Z_NO_FLUSH);
    if (state == Z_STREAM_ERROR) throw std::logic_error("deflate: the stream is broken");
    packed.resize(packed.size() - stream.z.avail_out);
  }
  return packed;
}

}  // namespace standoff
