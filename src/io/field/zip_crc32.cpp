#include "io/field/zip_crc32.h"

#include <array>
#include <cstring>

namespace standoff {
namespace {

// Sixteen bytes a step: tables[n][b] is the checksum of byte b followed by n zero bytes, so the terms of a step do not
// wait for each other.
constexpr std::size_t kStep = 16;
using Tables = std::array<std::array<std::uint32_t, 256>, kStep>;

constexpr Tables make_tables() {
  Tables tables{};
  for (std::uint32_t b = 0; b < 256; ++b) {
    std::uint32_t crc = b;
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1) ^ ((crc & 1) ? 0xEDB88320u : 0u);
    tables[0][b] = crc;
  }
  for (std::size_t n = 1; n < kStep; ++n)
    for (std::size_t b = 0; b < 256; ++b) {
      const std::uint32_t crc = tables[n - 1][b];
      tables[n][b] = (crc >> 8) ^ tables[0][crc & 0xFF];
    }
  return tables;
}

constexpr Tables kTables = make_tables();

}  // namespace

std::uint32_t crc32(std::span<const std::byte> bytes, std::uint32_t before) {
  std::uint32_t crc = ~before;
  const auto* at = reinterpret_cast<const unsigned char*>(bytes.data());
  std::size_t left = bytes.size();
  for (; left >= kStep; left -= kStep, at += kStep) {
    std::array<std::uint32_t, 4> words;
    std::memcpy(words.data(), at, kStep);
    words[0] ^= crc;
    crc = 0;
    // Left as a loop it runs at a third of the speed.
#pragma GCC unroll 16
    for (std::size_t b = 0; b < kStep; ++b) crc ^= kTables[kStep - 1 - b][(words[b / 4] >> (8 * (b % 4))) & 0xFF];
  }
  for (; left > 0; --left) crc = (crc >> 8) ^ kTables[0][(crc ^ *at++) & 0xFF];
  return ~crc;
}

}  // namespace standoff
