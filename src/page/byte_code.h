// SPDX-License-Identifier: Apache-2.0
// Numbers as bytes that pack well: view/page/blob.js has the other half.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace standoff::page {

/// 0, -1, 1, -2 .. as 0, 1, 2, 3 ..: what is small in magnitude has few bits.
constexpr std::uint32_t zigzag(std::int32_t n) {
  return (static_cast<std::uint32_t>(n) << 1) ^ static_cast<std::uint32_t>(n >> 31);
}

/// The lowest byte of every number, then the second byte of every number, and so on: bytes of one kind pack better.
inline void put_planes(std::string& out, std::span<const std::uint32_t> numbers, int bytes) {
  out.reserve(out.size() + numbers.size() * static_cast<std::size_t>(bytes));
  for (int byte = 0; byte < bytes; ++byte)
    for (const std::uint32_t n : numbers) out += static_cast<char>(n >> (8 * byte));
}

/// Seven bits in a byte, the lowest first; all bytes but the last have their highest bit set.
inline void put_varint(std::string& out, std::uint32_t n) {
  for (; n >= 0x80; n >>= 7) out += static_cast<char>(n | 0x80);
  out += static_cast<char>(n);
}

}  // namespace standoff::page
