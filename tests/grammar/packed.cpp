// SPDX-License-Identifier: Apache-2.0
#include "tests/grammar/packed.h"

#include <zlib.h>

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

}  // namespace standoff::grammar
