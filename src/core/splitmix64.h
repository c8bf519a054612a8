// SPDX-License-Identifier: Apache-2.0
// Numbers that look random from 64 bits, the same on every machine: S. Vigna's splitmix64, after Steele, Lea and Flood,
// "Fast splittable pseudorandom number generators" (2014).
#pragma once

#include <cstdint>

namespace standoff {

/// The generator's state steps by this: 2^64 over the golden ratio, rounded to an odd number.
inline constexpr std::uint64_t kSplitmixStep = 0x9e3779b97f4a7c15u;

/// What splitmix64 gives when its state is `x` before the step: every bit of `x` reaches every bit of it.
constexpr std::uint64_t splitmix64(std::uint64_t x) {
  x += kSplitmixStep;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

}  // namespace standoff
