// SPDX-License-Identifier: Apache-2.0
// What the tests of updates share: options, and whether two fields have the same tiles.
#pragma once

#include <cstdint>
#include <cstring>

#include "standoff/compute.h"
#include "standoff/field.h"
#include "standoff/mesh.h"

namespace standoff::testing {

inline ComputeOptions update_options(SignMethod method, bool as_oriented = false) {
  return {.sign = {.method = method, .as_oriented = as_oriented, .shell = method == SignMethod::shell ? 0.05 : 0},
          .execution = {.threads = 2, .backend = Backend::cpu}};
}

template <class A, class B>
bool same_bytes(const A& a, const B& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(a[0])) == 0;
}

/// The number of tiles that differ: in values, nearest triangles, marks, or whether they are stored.
inline std::int64_t differing_tiles(const DistanceField& a, const DistanceField& b) {
  std::int64_t wrong = 0;
  const Size3 tiles = b.tile_count();
  for (std::int64_t z = 0; z < tiles.z; ++z)
    for (std::int64_t y = 0; y < tiles.y; ++y)
      for (std::int64_t x = 0; x < tiles.x; ++x) {
        const auto one = a.tile(x, y, z), other = b.tile(x, y, z);
        bool same = one.has_value() == other.has_value() && a.background(x, y, z) == b.background(x, y, z);
        if (same && one) same = same_bytes(*one, *other);
        if (same && one && b.has_nearest()) same = same_bytes(*a.tile_nearest(x, y, z), *b.tile_nearest(x, y, z));
        wrong += !same;
      }
  return wrong;
}

}  // namespace standoff::testing
