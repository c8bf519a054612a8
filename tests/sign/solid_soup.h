// SPDX-License-Identifier: Apache-2.0
// Closed meshes whose winding numbers are known without any ray: tetrahedra, each a closed mesh of its own. They
// overlap and intersect at random, some are turned inside out.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "standoff/mesh.h"
#include "tests/support/random_mesh.h"

namespace standoff::testing {

using Tetrahedron = std::array<Vec3, 4>;

inline void add_tetrahedron(Mesh& mesh, const Tetrahedron& t) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), t.begin(), t.end());
  constexpr std::uint32_t faces[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
  for (const auto& face : faces) mesh.triangles.push_back({first + face[0], first + face[1], first + face[2]});
}

inline Mesh mesh_of(const std::vector<Tetrahedron>& tetrahedra) {
  Mesh mesh;
  for (const Tetrahedron& t : tetrahedra) add_tetrahedron(mesh, t);
  return mesh;
}

/// So many random ones near each other; about half are inside out.
inline Mesh solid_soup(unsigned seed, int count) {
  Random random(seed);
  std::vector<Tetrahedron> all;
  for (int n = 0; n < count; ++n) {
    const Vec3 at = random.in_cube(1);
    all.push_back({at + random.in_cube(1), at + random.in_cube(1), at + random.in_cube(1), at + random.in_cube(1)});
  }
  return mesh_of(all);
}

/// Corners are integers of magnitude at most `half`, many of them equal to others or on one line with them.
inline std::vector<Tetrahedron> integer_tetrahedra(Random& random, int count, std::uint32_t half) {
  std::vector<Tetrahedron> all;
  const auto coordinate = [&] { return double(random.below(2 * half + 1)) - double(half); };
  for (int n = 0; n < count; ++n) {
    Tetrahedron t;
    for (Vec3& v : t) v = {coordinate(), coordinate(), coordinate()};
    all.push_back(t);
  }
  return all;
}

/// The determinant of the corners' differences, exactly. Requires integers of magnitude at most 2^38.
inline int orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  using Wide = __int128;
  const auto minus = [&](const Vec3& v) {
    return std::array<Wide, 3>{Wide(v.x) - Wide(a.x), Wide(v.y) - Wide(a.y), Wide(v.z) - Wide(a.z)};
  };
  const auto u = minus(b), v = minus(c), w = minus(d);
  const Wide value =
      u[0] * (v[1] * w[2] - v[2] * w[1]) - u[1] * (v[0] * w[2] - v[2] * w[0]) + u[2] * (v[0] * w[1] - v[1] * w[0]);
  return (value > 0) - (value < 0);
}

struct KnownWinding {
  std::int32_t winding = 0;
  bool on_surface = false;
};

/// What the point's winding number is, by which tetrahedra it is inside. Requires integers.
inline KnownWinding known_winding(const std::vector<Tetrahedron>& tetrahedra, const Vec3& p) {
  KnownWinding known;
  for (const Tetrahedron& t : tetrahedra) {
    const int whole = orientation(t[0], t[1], t[2], t[3]);
    const int sides[4] = {orientation(p, t[1], t[2], t[3]), orientation(t[0], p, t[2], t[3]),
                          orientation(t[0], t[1], p, t[3]), orientation(t[0], t[1], t[2], p)};
    bool inside = whole != 0, outside = false, on_plane = false;
    for (const int side : sides) {
      inside = inside && side == whole;
      outside = outside || (whole != 0 && side == -whole);
      on_plane = on_plane || side == 0;
    }
    if (inside) known.winding += whole;
    // A flat tetrahedron cancels itself out, but points in its plane may be on its faces.
    if (!inside && !outside && on_plane) known.on_surface = true;
  }
  return known;
}

}  // namespace standoff::testing
