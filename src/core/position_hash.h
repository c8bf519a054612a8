// SPDX-License-Identifier: Apache-2.0
// Hashes of positions: equal positions have equal hashes, where -0 equals +0.
#pragma once

#include <bit>
#include <cstdint>

#include "standoff/vec.h"

namespace standoff {

/// Both numbers multiplied and folded to 64 bits: every bit of both reaches every bit of the result.
inline std::uint64_t folded_product(std::uint64_t a, std::uint64_t b) {
  const auto product = static_cast<unsigned __int128>(a) * b;
  return static_cast<std::uint64_t>(product) ^ static_cast<std::uint64_t>(product >> 64);
}

/// The bits of a coordinate; those of 0 for -0.
inline std::uint64_t position_bits(double c) { return std::bit_cast<std::uint64_t>(c + 0.0); }

/// A hash of 64 bits; another one for each seed. The constants have no structure: digits of pi.
inline std::uint64_t position_hash(const Vec3& p, std::uint64_t seed = 0) {
  const std::uint64_t xy =
      folded_product(position_bits(p.x) ^ 0x243f6a8885a308d3u ^ seed, position_bits(p.y) ^ 0x13198a2e03707345u);
  return folded_product(xy ^ position_bits(p.z), 0xa4093822299f31d1u);
}

}  // namespace standoff
