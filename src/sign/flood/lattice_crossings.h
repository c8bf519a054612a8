// SPDX-License-Identifier: Apache-2.0
// The edges of a lattice of samples that a triangle crosses, along x, y and z, exactly: every sample stands for one
// point, which is the same for its edges along all axes (ray_crossing.h). So a closed path along edges crosses a closed
// mesh an even number of times.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "sign/flood/tile_lattice.h"
#include "sign/rows/ray_crossing.h"

namespace standoff {

/// How an edge crosses a triangle.
struct EdgeHit {
  int crossing;  ///< 1 where the normal points along the axis, -1 where it points against it
  double at;     ///< about the coordinate along the axis; any number where rounding hides it
};

/// Calls use(axis, sample, hit): the edge from that sample to the next one along the axis crosses the triangle.
template <class Use>
void for_each_edge_hit(const std::array<Vec3, 3>& corners, const std::array<LatticeAxis, 3>& axes, const Use& use) {
  const auto part = [](const Vec3& v, std::size_t axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; };
  // Half open: samples are displaced upwards, so a line at the largest coordinate passes beside the triangle.
  std::array<std::int64_t, 3> first, past;
  for (std::size_t n = 0; n < 3; ++n) {
    const auto [low, high] = std::minmax({part(corners[0], n), part(corners[1], n), part(corners[2], n)});
    first[n] = axes[n].first_from(low);
    past[n] = axes[n].first_from(high);
  }
  for (std::size_t a = 0; a < 3; ++a) {
    const std::size_t b = (a + 1) % 3, c = (a + 2) % 3;
    if (first[b] == past[b] || first[c] == past[c]) continue;
    std::array<Vec3, 3> turned;
    for (std::size_t n = 0; n < 3; ++n) turned[n] = {part(corners[n], a), part(corners[n], b), part(corners[n], c)};
    // All are displaced most along y, which is axis 1, 0 or 2 of the turned ones.
    const RayTriangle ray(turned, static_cast<int>((4 - a) % 3));
    for (std::int64_t k = first[c]; k < past[c]; ++k)
      for (std::int64_t j = first[b]; j < past[b]; ++j) {
        const double y = axes[b].at(j), z = axes[c].at(k);
        const int crossing = ray.crossing(y, z);
        if (crossing == 0) continue;
        const double x = ray.crossing_x(y, z);
        const std::int64_t beyond = axes[a].first(x, [&](std::int64_t n) {
          return ray.is_past({axes[a].at(n), y, z}, crossing);
        });
        if (beyond == 0 || beyond == axes[a].size()) continue;
        std::array<std::int64_t, 3> sample;
        sample[a] = beyond - 1;
        sample[b] = j;
        sample[c] = k;
        use(a, sample, EdgeHit{crossing, x});
      }
  }
}

/// The same with use(axis, sample).
template <class Use>
void for_each_crossed_edge(const std::array<Vec3, 3>& corners, const std::array<LatticeAxis, 3>& axes, const Use& use) {
  for_each_edge_hit(corners, axes, [&](std::size_t axis, const auto& sample, const EdgeHit&) { use(axis, sample); });
}

}  // namespace standoff
