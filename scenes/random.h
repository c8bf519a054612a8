// SPDX-License-Identifier: Apache-2.0
// Numbers that look random and are the same everywhere: integer hashing, no state, no standard distributions.
#pragma once

#include <cstdint>

namespace standoff::scenes {

/// splitmix64, as in src/core, which scenes do not see: these are made through the public headers alone, and a scene
/// must stay the same whatever becomes of the library.
constexpr std::uint64_t hash(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

/// A number in [0, 1), a multiple of 2^-53, that depends on the key alone. Keys rather than a running state: a part
/// keeps its place and shape when another one is left out.
constexpr double uniform(std::uint64_t key) { return static_cast<double>(hash(key) >> 11) * 0x1p-53; }
constexpr double uniform(std::uint64_t a, std::uint64_t b) { return uniform(hash(a) ^ b); }
constexpr double uniform(std::uint64_t a, std::uint64_t b, std::uint64_t c) { return uniform(hash(hash(a) ^ b) ^ c); }

/// A number in [low, high).
constexpr double between(double low, double high, double u) { return low + (high - low) * u; }

}  // namespace standoff::scenes
