// SPDX-License-Identifier: Apache-2.0
// More meshes with known properties, in the ways in which files are broken. See ../shapes.h for the simpler ones.
#pragma once

#include <cmath>
#include <utility>
#include <vector>

#include "tests/sign/shapes.h"

namespace standoff::testing {

/// |x| + |y| + |z| < r.
inline Mesh octahedron(double r, bool inside_out = false) {
  Mesh mesh;
  mesh.vertices = {{r, 0, 0}, {-r, 0, 0}, {0, r, 0}, {0, -r, 0}, {0, 0, r}, {0, 0, -r}};
  for (std::uint32_t n = 0; n < 8; ++n) {
    const std::uint32_t x = n & 1, y = 2 + (n >> 1 & 1), z = 4 + (n >> 2 & 1);
    const bool even = (x + y + z) % 2 == 0;
    mesh.triangles.push_back(even != inside_out ? Triangle{x, y, z} : Triangle{x, z, y});
  }
  return mesh;
}

/// The prism over a closed polygon that may cross itself, from z = 0 to 1; its caps are fans about the origin. Where
/// the polygon winds w times about (x, y), the prism winds w times about (x, y, z).
inline Mesh prism(const std::vector<std::pair<double, double>>& polygon) {
  Mesh mesh;
  const auto n = static_cast<std::uint32_t>(polygon.size());
  for (const double z : {0.0, 1.0}) {
    for (const auto& [x, y] : polygon) mesh.vertices.push_back({x, y, z});
    mesh.vertices.push_back({0, 0, z});
  }
  const std::uint32_t top = n + 1;
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t j = (i + 1) % n;
    mesh.triangles.insert(mesh.triangles.end(),
                          {{i, j, top + j}, {i, top + j, top + i}, {n, j, i}, {top + n, top + i, top + j}});
  }
  return mesh;
}

/// Each triangle's corners are moved by themselves, by up to `far` along each axis: neighbours no longer meet.
inline Mesh cracked(const Mesh& mesh, double far, unsigned seed) {
  Mesh apart = unwelded(mesh);
  Random random(seed);
  for (Vec3& v : apart.vertices) v = v + random.in_cube(far);
  return apart;
}

/// The same as a file of floats gives it, whose writer rounded each corner by itself: to the float below or above.
inline Mesh cracked_floats(const Mesh& mesh, unsigned seed) {
  Mesh apart = unwelded(mesh);
  Random random(seed);
  const auto near = [&](double x) {
    const auto rounded = static_cast<float>(x);
    return double(random.below(2) == 0 ? rounded : std::nextafter(rounded, random.below(2) == 0 ? -1e9f : 1e9f));
  };
  for (Vec3& v : apart.vertices) v = {near(v.x), near(v.y), near(v.z)};
  return apart;
}

/// A box whose faces are cut otherwise than their neighbours, n x n, 2n x 2n and 3n x 3n: vertices lie within edges.
inline Mesh box_of_t_junctions(Vec3 low, Vec3 high, std::uint32_t n) {
  Mesh mesh;
  const Vec3 extent = high - low;
  for (int face = 0; face < 6; ++face) {
    const int axis = face / 2;
    const Mesh sheet = surface(
        n * std::uint32_t(axis + 1), n * std::uint32_t(axis + 1),
        [&](double u, double v) {
          const double w = face % 2;
          const Vec3 at = axis == 0 ? Vec3{w, u, v} : axis == 1 ? Vec3{v, w, u} : Vec3{u, v, w};
          return low + extent * at;
        },
        [](std::uint32_t i, std::uint32_t j) {
          return Place{i, j};
        });
    mesh = joined(std::move(mesh), face % 2 == 0 ? reversed(sheet) : sheet);
  }
  return mesh;
}

/// Turns each triangle around with this probability. `turned` gets how many.
inline Mesh randomly_turned(Mesh mesh, unsigned seed, std::int64_t& turned, double share = 0.5) {
  Random random(seed);
  turned = 0;
  for (Triangle& t : mesh.triangles)
    if (random.between(0, 1) < share) {
      std::swap(t[1], t[2]);
      ++turned;
    }
  return mesh;
}

/// Without a random share of its triangles.
inline Mesh with_holes(Mesh mesh, double share, unsigned seed) {
  Random random(seed);
  std::erase_if(mesh.triangles, [&](const Triangle&) { return random.between(0, 1) < share; });
  return mesh;
}

/// Without the triangles whose corners are all above z.
inline Mesh cut_off(Mesh mesh, double z) {
  std::erase_if(mesh.triangles, [&](const Triangle& t) {
    return mesh.vertices[t[0]].z > z && mesh.vertices[t[1]].z > z && mesh.vertices[t[2]].z > z;
  });
  return mesh;
}

/// Every face twice, the second time turned around. `welded`: over the same vertices.
inline Mesh two_sided(Mesh mesh, bool welded = false) {
  if (!welded) return joined(mesh, reversed(mesh));
  const Mesh back = reversed(mesh);
  mesh.triangles.insert(mesh.triangles.end(), back.triangles.begin(), back.triangles.end());
  return mesh;
}

/// With triangles that have no area: points, segments there and back, on corners and along edges and across the inside.
inline Mesh with_degenerate(Mesh mesh, unsigned seed, int count) {
  Random random(seed);
  const auto some = [&] { return mesh.triangles[random.below(static_cast<std::uint32_t>(mesh.triangles.size()))]; };
  for (int n = 0; n < count; ++n) {
    const Triangle t = some(), other = some();
    const Triangle kinds[] = {{t[0], t[0], t[0]}, {t[0], t[1], t[1]}, {t[2], t[0], t[2]}, {t[0], other[1], t[0]}};
    mesh.triangles.push_back(kinds[random.below(4)]);
  }
  return shuffled(std::move(mesh), seed);
}

/// Each triangle becomes three about a point that is on its edge, or so close to it that the third is a needle. Still
/// closed: the cut is within the triangle.
inline Mesh with_needles(const Mesh& mesh, double height) {
  Mesh cut;
  cut.vertices = mesh.vertices;
  for (const Triangle& t : mesh.triangles) {
    const auto m = static_cast<std::uint32_t>(cut.vertices.size());
    const Vec3 a = mesh.vertices[t[0]], b = mesh.vertices[t[1]], c = mesh.vertices[t[2]];
    cut.vertices.push_back((a + b) * 0.5 + (c - (a + b) * 0.5) * height);
    cut.triangles.insert(cut.triangles.end(), {{t[0], t[1], m}, {t[1], t[2], m}, {t[2], t[0], m}});
  }
  return cut;
}

}  // namespace standoff::testing
