// SPDX-License-Identifier: Apache-2.0
// A ball that faces outwards, with shared vertices.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <utility>

#include "standoff/mesh.h"
#include "tests/collision/bodies.h"

namespace standoff::testing {

inline Mesh welded_ball(double radius, int cuts, Vec3 center = {}) {
  const Mesh octants = ball_mesh(radius, cuts, center);
  Mesh mesh;
  std::map<std::array<double, 3>, std::uint32_t> known;
  for (Triangle t : octants.triangles) {
    const Vec3 a = octants.vertices[t[0]], b = octants.vertices[t[1]], c = octants.vertices[t[2]];
    if (dot(cross(b - a, c - a), a - center) < 0) std::swap(t[1], t[2]);
    for (std::uint32_t& v : t) {
      const Vec3 p = octants.vertices[v] + Vec3{0, 0, 0};  // no -0
      const auto [at, is_new] = known.try_emplace({p.x, p.y, p.z}, static_cast<std::uint32_t>(mesh.vertices.size()));
      if (is_new) mesh.vertices.push_back(p);
      v = at->second;
    }
    mesh.triangles.push_back(t);
  }
  return mesh;
}

}  // namespace standoff::testing
