// SPDX-License-Identifier: Apache-2.0
#include "render/thinned.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <cstdint>

namespace standoff {
namespace {

constexpr std::uint32_t kLarge = 0xFFFFFFFF;  // no cube's number

bool is_small(Float3 a, Float3 b, Float3 c, float size) {
  const auto within = [size](float p, float q, float r) { return std::max({p, q, r}) - std::min({p, q, r}) < size; };
  return within(a.x, b.x, c.x) && within(a.y, b.y, c.y) && within(a.z, b.z, c.z);
}

}  // namespace

std::vector<Triangle> thinned(std::span<const Float3> places, TriangleArray triangles, float size) {
  const auto side = static_cast<std::uint32_t>(2 / size) + 1;  // of the cubes around the unit sphere
  const auto cube = [&](Float3 p) {
    const auto along = [&](float x) {
      return std::min(side - 1, static_cast<std::uint32_t>(std::max(0.0F, (x + 1) / size)));
    };
    return along(p.x) + side * (along(p.y) + side * along(p.z));
  };
  std::vector<std::uint32_t> cubes(triangles.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, cubes.size(), 1 << 14), [&](const auto& range) {
    for (std::size_t n = range.begin(); n < range.end(); ++n) {
      const Triangle t = triangles[n];
      const Float3 &a = places[t[0]], &b = places[t[1]], &c = places[t[2]];
      cubes[n] = is_small(a, b, c, size) ? cube(a) : kLarge;
    }
  });
  // In the order of the triangles, by one thread: which is kept must not depend on the number of threads.
  std::vector<bool> taken(std::size_t{side} * side * side);
  std::vector<Triangle> kept;
  for (std::size_t n = 0; n < cubes.size(); ++n) {
    if (cubes[n] != kLarge) {
      if (taken[cubes[n]]) continue;
      taken[cubes[n]] = true;
    }
    kept.push_back(triangles[n]);
  }
  return kept;
}

}  // namespace standoff
