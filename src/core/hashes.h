// SPDX-License-Identifier: Apache-2.0
// Hashes: of 64 bits, and of positions.
#pragma once

#include <bit>
#include <cstdint>

#include "standoff/vec.h"

namespace standoff {

// Numbers that look random from 64 bits, the same on every machine: S. Vigna's splitmix64, after Steele, Lea and Flood,
// "Fast splittable pseudorandom number generators" (2014).

/// The generator's state steps by this: 2^64 over the golden ratio, rounded to an odd number.
inline constexpr std::uint64_t kSplitmixStep = 0x9e3779b97f4a7c15u;

/// What splitmix64 gives when its state is `x` before the step: every bit of `x` reaches every bit of it.
constexpr std::uint64_t splitmix64(std::uint64_t x) {
  x += kSplitmixStep;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

// Positions: equal ones have equal hashes, where -0 equals +0.

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
