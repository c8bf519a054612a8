// SPDX-License-Identifier: Apache-2.0
// A box of many triangles.
#pragma once

#include "tests/sign/shapes.h"

namespace standoff::testing {

/// m x m rectangles on each side. `other`: with the other diagonal.
inline Mesh fine_box(Vec3 low, Vec3 high, std::uint32_t m, bool other = false) {
  const Vec3 e = high - low;
  Mesh mesh;
  const auto face = [&](Vec3 at, Vec3 u, Vec3 v) {
    Mesh one = surface(
        m, m, [&](double a, double b) { return low + (at + u * a + v * b) * e; },
        [](std::uint32_t i, std::uint32_t j) {
          return Place{i, j};
        });
    if (other)
      for (std::size_t t = 0; t < one.triangles.size(); t += 2) {
        const auto [p, q, r] = one.triangles[t];
        const std::uint32_t s = one.triangles[t + 1][2];
        one.triangles[t] = {p, q, s};
        one.triangles[t + 1] = {q, r, s};
      }
    mesh = joined(mesh, one);
  };
  const Vec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
  face({}, y, x), face({}, z, y), face({}, x, z);
  face(z, x, y), face(x, y, z), face(y, z, x);
  return mesh;
}

}  // namespace standoff::testing
