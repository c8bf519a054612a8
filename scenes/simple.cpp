// SPDX-License-Identifier: Apache-2.0
// Sphere, box, terrain: shapes whose distances can be written down, or that come in any size.

#include "scenes/families.h"
#include "scenes/random.h"

namespace standoff::scenes {

Mesh sphere_of(int n, Vec3 center, double radius) {
  // The faces of an octahedron, each divided into n * n, pushed out to the sphere. Row j of a face has j + 1 vertices;
  // rows of the four faces around the y axis join to rings.
  Mesh mesh;
  const auto add = [&](Vec3 p) {
    mesh.vertices.push_back(center + normalized(p) * radius);
    return static_cast<std::uint32_t>(mesh.vertices.size() - 1);
  };
  const std::vector<Vec3> corners{{0, 0, 1}, Vec3{1, 0, 0}, Vec3{0, 0, -1}, Vec3{-1, 0, 0}};
  std::vector<std::uint32_t> rings;  // first vertex of every ring, top to bottom
  for (int j = 0; j <= 2 * n; ++j) {
    rings.push_back(static_cast<std::uint32_t>(mesh.vertices.size()));
    const int m = j <= n ? j : 2 * n - j;
    const double y = double(n - j) / n, reach = double(m) / n;
    if (m == 0) {
      add({0, y, 0});
      continue;
    }
    for (int q = 0; q < 4; ++q)
      for (int i = 0; i < m; ++i)
        add(Vec3{0, y, 0} + (corners[q] * (double(m - i) / m) + corners[(q + 1) % 4] * (double(i) / m)) * reach);
  }
  const auto at = [&](int j, int q, int i) {
    const int m = j <= n ? j : 2 * n - j;
    return rings[j] + (m == 0 ? 0u : static_cast<std::uint32_t>((q * m + i) % (4 * m)));
  };
  for (int j = 0; j < 2 * n; ++j) {
    const bool upper = j < n;
    const int m = upper ? j : 2 * n - j - 1;  // pieces of the shorter of the two rings
    const int longer = upper ? j + 1 : j, shorter = upper ? j : j + 1;
    for (int q = 0; q < 4; ++q) {
      for (int i = 0; i <= m; ++i) {
        if (upper) {
          mesh.triangles.push_back({at(longer, q, i), at(longer, q, i + 1), at(shorter, q, i)});
          if (i < m) mesh.triangles.push_back({at(longer, q, i + 1), at(shorter, q, i + 1), at(shorter, q, i)});
        } else {
          mesh.triangles.push_back({at(longer, q, i), at(shorter, q, i), at(longer, q, i + 1)});
          if (i < m) mesh.triangles.push_back({at(longer, q, i + 1), at(shorter, q, i), at(shorter, q, i + 1)});
        }
      }
    }
  }
  return mesh;
}

Mesh make_sphere(std::int64_t triangles) {
  int n = 1;  // 8 n^2 triangles: the nearest to the wanted number
  while (8 * std::int64_t{n} * n < triangles) ++n;
  if (n > 1 && 8 * std::int64_t{n} * n - triangles > triangles - 8 * std::int64_t{n - 1} * (n - 1)) --n;
  return sphere_of(n, {}, 1);
}

Mesh make_box(std::int64_t triangles) {
  Mesh mesh{{{-1, -0.75, -0.5},
             {1, -0.75, -0.5},
             {-1, 0.75, -0.5},
             {1, 0.75, -0.5},
             {-1, -0.75, 0.5},
             {1, -0.75, 0.5},
             {-1, 0.75, 0.5},
             {1, 0.75, 0.5}},
            {{0, 2, 3},
             {0, 3, 1},
             {4, 5, 7},
             {4, 7, 6},
             {0, 4, 6},
             {0, 6, 2},
             {1, 3, 7},
             {1, 7, 5},
             {0, 1, 5},
             {0, 5, 4},
             {2, 6, 7},
             {2, 7, 3}}};
  split_to(mesh, triangles);
  return mesh;
}

namespace {

// Smooth noise in [0, 1]: hashed values on the integers, blended with a polynomial.
double noise(double x, double z, std::uint64_t seed) {
  const double fx = std::floor(x), fz = std::floor(z);
  const auto ix = static_cast<std::int64_t>(fx), iz = static_cast<std::int64_t>(fz);
  const auto value = [&](int dx, int dz) { return uniform(seed, std::uint64_t(ix + dx), std::uint64_t(iz + dz)); };
  const auto blend = [](double t) { return t * t * (3 - 2 * t); };
  const double u = blend(x - fx), v = blend(z - fz);
  return (value(0, 0) * (1 - u) + value(1, 0) * u) * (1 - v) + (value(0, 1) * (1 - u) + value(1, 1) * u) * v;
}

double height(double x, double z) {
  double y = 0, amplitude = 12;
  double step = 1.0 / 32;
  for (std::uint64_t octave = 0; octave < 7; ++octave, step *= 2, amplitude *= 0.45) {
    const double ridge = 1 - std::abs(2 * noise(x * step, z * step, octave) - 1);
    y += amplitude * ridge * ridge;
  }
  return y;
}

}  // namespace

Mesh make_terrain(std::int64_t triangles) {
  constexpr double kSide = 100;
  std::int64_t n = 1;
  while (2 * (n + 1) * (n + 1) <= triangles) ++n;
  Mesh mesh;
  const double step = kSide / static_cast<double>(n);
  for (std::int64_t k = 0; k <= n; ++k)
    for (std::int64_t i = 0; i <= n; ++i) {
      const double x = step * static_cast<double>(i), z = step * static_cast<double>(k);
      mesh.vertices.push_back({x, height(x, z), z});
    }
  const auto at = [&](std::int64_t i, std::int64_t k) { return static_cast<std::uint32_t>(i + (n + 1) * k); };
  for (std::int64_t k = 0; k < n; ++k)
    for (std::int64_t i = 0; i < n; ++i) {
      mesh.triangles.push_back({at(i, k), at(i, k + 1), at(i + 1, k + 1)});
      mesh.triangles.push_back({at(i, k), at(i + 1, k + 1), at(i + 1, k)});
    }
  split_to(mesh, triangles);
  return mesh;
}

}  // namespace standoff::scenes
