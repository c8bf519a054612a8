// SPDX-License-Identifier: Apache-2.0
// Hashes: of 64 bits, and of positions.
#pragma once

#include <bit>
#include <cstdint>

#include "standoff/vec.h"

namespace standoff {

// S. Vigna's splitmix64 makes numbers that look random from 64 bits, the same on every machine; after Steele, Lea and
// Flood, "Fast splittable pseudorandom number generators" (2014).

/// The step of the generator's state: 2^64 over the golden ratio, rounded to an odd number.
inline constexpr std::uint64_t kSplitmixStep = 0x9e3779b97f4a7c15u;

/// The number that splitmix64 returns if its state is `x` before the step. Each of its bits depends on every bit of
/// `x`.
constexpr std::uint64_t splitmix64(std::uint64_t x) {
  x += kSplitmixStep;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

// Equal positions have equal hashes, where -0 equals +0.

/// The product of both numbers, folded to 64 bits: each bit of the result depends on every bit of both.
constexpr std::uint64_t folded_product(std::uint64_t a, std::uint64_t b) {
  const auto product = static_cast<unsigned __int128>(a) * b;
  return static_cast<std::uint64_t>(product) ^ static_cast<std::uint64_t>(product >> 64);
}

/// The bits of a coordinate; -0 has the bits of +0.
constexpr std::uint64_t position_bits(double c) { return std::bit_cast<std::uint64_t>(c + 0.0); }

/// A hash of 64 bits, different for each seed. The constants are digits of pi, which have no structure.
constexpr std::uint64_t position_hash(const Vec3& p, std::uint64_t seed = 0) {
  const std::uint64_t xy =
      folded_product(position_bits(p.x) ^ 0x243f6a8885a308d3u ^ seed, position_bits(p.y) ^ 0x13198a2e03707345u);
  return folded_product(xy ^ position_bits(p.z), 0xa4093822299f31d1u);
}

}  // namespace standoff
