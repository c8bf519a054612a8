// SPDX-License-Identifier: Apache-2.0
#include "io/field/blosc.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <vector>

namespace standoff::vdb {
namespace {

// A block of LZ4: false unless it becomes exactly `to`.
bool unpack_lz4(std::string_view from, std::span<char> to) {
  std::size_t in = 0, out = 0;
  const auto more = [&](std::size_t& length) {
    for (unsigned char next = 255; next == 255; length += next) {
      if (in == from.size()) return false;
      next = static_cast<unsigned char>(from[in++]);
    }
    return true;
  };
  while (in < from.size()) {
    const auto token = static_cast<unsigned char>(from[in++]);
    std::size_t literals = token >> 4, match = token & 15;
    if (literals == 15 && !more(literals)) return false;
    if (literals > from.size() - in || literals > to.size() - out) return false;
    std::copy_n(from.data() + in, literals, to.data() + out);
    in += literals;
    out += literals;
    if (in == from.size()) return out == to.size();  // the last part has no match
    if (from.size() - in < 2) return false;
    const std::size_t distance =
        static_cast<unsigned char>(from[in]) | std::size_t{static_cast<unsigned char>(from[in + 1])} << 8;
    in += 2;
    if (match == 15 && !more(match)) return false;
    match += 4;
    if (distance == 0 || distance > out || match > to.size() - out) return false;
    for (; match > 0; --match, ++out) to[out] = to[out - distance];  // may overlap
  }
  return false;
}

std::uint32_t u32(std::string_view bytes, std::size_t at) {
  std::uint32_t number;
  std::memcpy(&number, bytes.data() + at, sizeof number);
  return number;
}

}  // namespace

void unpack_blosc(const FileView& file, const std::string& where, std::string_view packed, std::span<char> to) {
  constexpr std::size_t kHeader = 16, kMostSplit = 16, kLeastSplit = 128;
  constexpr unsigned kShuffled = 1, kCopied = 2, kBitsShuffled = 4, kWhole = 16, kLz4 = 1;
  const auto fail = [&] { file.fail(where, "what Blosc packed is damaged; get the file again"); };
  if (packed.size() < kHeader) fail();
  const auto flags = static_cast<unsigned char>(packed[2]);
  const std::size_t type_bytes = std::max<std::size_t>(1, static_cast<unsigned char>(packed[3]));
  const std::size_t bytes = u32(packed, 4), block_bytes = u32(packed, 8), packed_bytes = u32(packed, 12);
  if (bytes != to.size() || packed_bytes != packed.size() || (bytes > 0 && block_bytes == 0)) fail();
  if (flags & kCopied) {
    if (packed.size() - kHeader != bytes) fail();
    std::copy_n(packed.data() + kHeader, bytes, to.data());
    return;
  }
  if (flags >> 5 != kLz4 || (flags & kBitsShuffled))
    file.fail(where, "Blosc packed it by another codec than LZ4, which is not read; save it with LZ4, zip or plain");
  const std::size_t blocks = bytes / block_bytes + (bytes % block_bytes > 0 ? 1 : 0);
  if (blocks > (packed.size() - kHeader) / 4) fail();
  std::vector<char> shuffled;
  for (std::size_t block = 0; block < blocks; ++block) {
    const std::size_t first = block * block_bytes, size = std::min(block_bytes, bytes - first);
    const bool split =
        !(flags & kWhole) && type_bytes <= kMostSplit && block_bytes / type_bytes >= kLeastSplit && size == block_bytes;
    const std::size_t parts = split ? type_bytes : 1, part_bytes = size / parts;
    if (part_bytes * parts != size) fail();
    std::span<char> out = to.subspan(first, size);
    const bool shuffle = (flags & kShuffled) && type_bytes > 1;
    if (shuffle) {
      shuffled.resize(size);
      out = shuffled;
    }
    std::size_t at = u32(packed, kHeader + 4 * block);
    for (std::size_t part = 0; part < parts; ++part) {
      if (at > packed.size() || packed.size() - at < 4) fail();
      const std::size_t length = u32(packed, at);
      at += 4;
      if (length > packed.size() - at) fail();
      const std::span<char> part_out = out.subspan(part * part_bytes, part_bytes);
      if (length == part_bytes)
        std::copy_n(packed.data() + at, length, part_out.data());
      else if (!unpack_lz4(packed.substr(at, length), part_out))
        fail();
      at += length;
    }
    if (!shuffle) continue;
    // All first bytes, all second ones and so on; what makes no whole number is at the end, as it is.
    const std::size_t numbers = size / type_bytes;
    for (std::size_t n = 0; n < numbers; ++n)
      for (std::size_t byte = 0; byte < type_bytes; ++byte)
        to[first + n * type_bytes + byte] = shuffled[byte * numbers + n];
    std::copy(shuffled.begin() + static_cast<std::ptrdiff_t>(numbers * type_bytes), shuffled.end(),
              to.begin() + static_cast<std::ptrdiff_t>(first + numbers * type_bytes));
  }
}

}  // namespace standoff::vdb
