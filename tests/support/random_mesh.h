// SPDX-License-Identifier: Apache-2.0
// Small random meshes and points for tests, the same on every machine.
#pragma once

#include <cmath>
#include <cstdint>
#include <iterator>
#include <random>

#include "standoff/mesh.h"

namespace standoff::testing {

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double between(double low, double high) { return low + (high - low) * static_cast<double>(engine_()) / 0x1p32; }
  std::uint32_t below(std::uint32_t n) { return static_cast<std::uint32_t>(engine_() % n); }
  Vec3 in_cube(double half) { return {between(-half, half), between(-half, half), between(-half, half)}; }

 private:
  std::mt19937 engine_;
};

inline std::vector<Vec3> points_around(unsigned seed, int count, double reach, Vec3 middle = {}) {
  Random random(seed);
  std::vector<Vec3> points;
  for (int n = 0; n < count; ++n) points.push_back(middle + random.in_cube(reach));
  return points;
}

inline void add_triangle(Mesh& mesh, Vec3 a, Vec3 b, Vec3 c) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), {a, b, c});
  mesh.triangles.push_back({first, first + 1, first + 2});
}

/// Unconnected triangles about `side` long, centred in a cube of half-width `half` around `center`.
inline Mesh random_soup(unsigned seed, int triangles, double half, double side, Vec3 center = {}) {
  Random random(seed);
  Mesh mesh;
  for (int n = 0; n < triangles; ++n) {
    const Vec3 at = center + random.in_cube(half);
    add_triangle(mesh, at + random.in_cube(side), at + random.in_cube(side), at + random.in_cube(side));
  }
  return mesh;
}

/// A soup in which corners sit on a coarse lattice and triangles come twice, turned around, as segments, as points, and
/// as parts of others.
inline Mesh nasty_soup(unsigned seed, int triangles, double half) {
  Random random(seed);
  Mesh mesh;
  const auto lattice = [&] {
    const Vec3 v = random.in_cube(half);
    return Vec3{std::round(v.x), std::round(v.y), std::round(v.z)};
  };
  for (int n = 0; n < triangles; ++n) {
    Vec3 a = lattice(), b = lattice(), c = lattice();
    if (!mesh.triangles.empty() && random.below(2) == 0) {
      const auto other = random.below(static_cast<std::uint32_t>(mesh.triangles.size()));
      const Vec3 p = mesh.vertices[3 * other], q = mesh.vertices[3 * other + 1], r = mesh.vertices[3 * other + 2];
      const Vec3 choices[][3] = {{p, q, r},
                                 {p, q, r},
                                 {q, r, p},
                                 {r, q, p},
                                 {p, p, p},
                                 {p, q, q},
                                 {p, (p + q) * 0.5, q},
                                 {p, q, (p + r) * 0.5},
                                 {p, (p + q) * 0.5, (p + r) * 0.5}};
      const auto& choice = choices[random.below(std::size(choices))];
      a = choice[0], b = choice[1], c = choice[2];
    }
    add_triangle(mesh, a, b, c);
  }
  return mesh;
}

/// Many more triangles than samples: a ball of them, and points on a sphere seen from inside and outside.
inline Mesh crowd(unsigned seed, int triangles) {
  Mesh mesh = random_soup(seed, triangles, 1.5, 0.15);
  Random random(seed + 1);
  for (int n = 0; n < triangles; ++n) {
    const Vec3 at = random.in_cube(1), on_sphere = at * (5 / length(at));
    add_triangle(mesh, on_sphere, on_sphere + random.in_cube(0.2), on_sphere + random.in_cube(0.2));
  }
  return mesh;
}

}  // namespace standoff::testing
