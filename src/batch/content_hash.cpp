// SPDX-License-Identifier: Apache-2.0
#include "batch/content_hash.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <system_error>

#include "core/hashes.h"
#include "files/file_view.h"

namespace standoff {
namespace {

static_assert(std::endian::native == std::endian::little, "words are read as they lie in memory");

std::uint64_t word_at(std::string_view bytes, std::size_t at) {
  std::uint64_t word = 0;
  std::memcpy(&word, bytes.data() + at, std::min<std::size_t>(8, bytes.size() - at));
  return word;
}

}  // namespace

// Four chains of two words each: one alone would wait for its own multiplications. The constants are digits of pi.
std::uint64_t content_hash(std::string_view bytes) {
  constexpr std::size_t kChains = 4, kStep = 16 * kChains;
  std::array<std::uint64_t, kChains> chain{0x243f6a8885a308d3u, 0x13198a2e03707344u, 0xa4093822299f31d0u,
                                           0x082efa98ec4e6c89u};
  const auto mix = [&](std::size_t c, std::uint64_t a, std::uint64_t b) {
    chain[c] = folded_product(chain[c] ^ a, b ^ 0x452821e638d01377u) + kSplitmixStep;
  };
  std::size_t at = 0;
  for (; bytes.size() - at >= kStep; at += kStep)
    for (std::size_t c = 0; c < kChains; ++c) mix(c, word_at(bytes, at + 16 * c), word_at(bytes, at + 16 * c + 8));
  for (std::size_t c = 0; at < bytes.size(); at += 8, c = (c + 1) % kChains) mix(c, word_at(bytes, at), at);
  std::uint64_t hash = bytes.size();
  for (const std::uint64_t end : chain) hash = splitmix64(hash ^ end);
  return hash;
}

std::uint64_t file_hash(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return 0;
  const std::uint64_t hash = content_hash(FileView(path, FileView::Access::map).bytes());
  return hash == 0 ? 1 : hash;
}

}  // namespace standoff
