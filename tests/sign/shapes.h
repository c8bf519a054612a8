// SPDX-License-Identifier: Apache-2.0
// Small meshes with known properties, and ways to damage them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <utility>

#include "standoff/mesh.h"
#include "tests/support/changed_mesh.h"
#include "tests/support/random_mesh.h"

namespace standoff::testing {

/// m x n quadrilaterals of two triangles over the unit square, mapped by point(u, v), with the normal du x dv.
/// Positions that agree (where the surface closes) are made equal by giving them equal u and v: `wrap` gets the numbers
/// of a sample, i in 0 to m and j in 0 to n, and returns those of the sample that stands for it.
template <class Point, class Wrap>
Mesh surface(std::uint32_t m, std::uint32_t n, const Point& point, const Wrap& wrap) {
  Mesh mesh;
  for (std::uint32_t j = 0; j <= n; ++j)
    for (std::uint32_t i = 0; i <= m; ++i) {
      const auto [k, l] = wrap(i, j);
      mesh.vertices.push_back(point(double(k) / m, double(l) / n));
    }
  const auto at = [&](std::uint32_t i, std::uint32_t j) { return i + (m + 1) * j; };
  for (std::uint32_t j = 0; j < n; ++j)
    for (std::uint32_t i = 0; i < m; ++i) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return mesh;
}

using Place = std::pair<std::uint32_t, std::uint32_t>;
inline constexpr double kTurn = 2 * std::numbers::pi;

/// About the x axis: tubes of radius r around a circle of radius R.
inline Mesh torus(std::uint32_t m = 24, std::uint32_t n = 12, double R = 1, double r = 0.3) {
  return surface(
      m, n,
      [=](double u, double v) {
        const double far = R + r * std::cos(kTurn * v);
        return Vec3{-r * std::sin(kTurn * v), far * std::sin(kTurn * u), far * std::cos(kTurn * u)};
      },
      [=](std::uint32_t i, std::uint32_t j) {
        return Place{i % m, j % n};
      });
}

/// Unit ball; triangles at the poles would have two equal corners and are left out.
inline Mesh sphere(std::uint32_t n = 8) {
  const std::uint32_t m = 2 * n;
  Mesh mesh = surface(
      m, n,
      [=](double u, double v) {
        const double s = v == 0 || v == 1 ? 0 : std::sin(kTurn / 2 * v);
        return Vec3{s * std::cos(kTurn * u), s * std::sin(kTurn * u), -std::cos(kTurn / 2 * v)};
      },
      [=](std::uint32_t i, std::uint32_t j) {
        return Place{j == 0 || j == n ? 0 : i % m, j};
      });
  std::erase_if(mesh.triangles, [&](const Triangle& t) {
    const auto& v = mesh.vertices;
    return v[t[0]] == v[t[1]] || v[t[1]] == v[t[2]] || v[t[2]] == v[t[0]];
  });
  return mesh;
}

/// A hilly square sheet, 2 by 2.
inline Mesh terrain(std::uint32_t n = 12, double height = 0.1) {
  return surface(
      n, n,
      [=](double u, double v) {
        return Vec3{2 * u - 1, 2 * v - 1, height * std::sin(7 * u) * std::cos(5 * v)};
      },
      [](std::uint32_t i, std::uint32_t j) {
        return Place{i, j};
      });
}

/// A strip of width 0.6 with a half twist.
inline Mesh moebius(std::uint32_t m = 24, std::uint32_t n = 4) {
  return surface(
      m, n,
      [](double u, double v) {
        const double s = 0.6 * (v - 0.5), far = 1 + s * std::cos(kTurn / 2 * u);
        return Vec3{far * std::cos(kTurn * u), far * std::sin(kTurn * u), s * std::sin(kTurn / 2 * u)};
      },
      [=](std::uint32_t i, std::uint32_t j) {
        return i == m ? Place{0, n - j} : Place{i, j};
      });
}

/// A figure of eight that turns by half while it goes round: closed, it intersects itself in a circle. n is odd, so
/// that no two samples fall together there.
inline Mesh klein_bottle(std::uint32_t m = 24, std::uint32_t n = 13) {
  return surface(
      m, n,
      [](double u, double v) {
        const double c = std::cos(kTurn / 2 * u), s = std::sin(kTurn / 2 * u);
        const double a = std::sin(kTurn * v), b = std::sin(2 * kTurn * v), far = 2 + c * a - s * b;
        return Vec3{far * std::cos(kTurn * u), far * std::sin(kTurn * u), s * a + c * b};
      },
      [=](std::uint32_t i, std::uint32_t j) {
        return i == m ? Place{0, (n - j % n) % n} : Place{i, j % n};
      });
}

inline Mesh box(Vec3 low = {0, 0, 0}, Vec3 high = {1, 1, 1}) {
  Mesh mesh;
  for (int n = 0; n < 8; ++n)
    mesh.vertices.push_back({n & 1 ? high.x : low.x, n & 2 ? high.y : low.y, n & 4 ? high.z : low.z});
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

inline Mesh without(Mesh mesh, std::size_t triangle) {
  mesh.triangles.erase(mesh.triangles.begin() + static_cast<std::ptrdiff_t>(triangle));
  return mesh;
}

inline Mesh with_flipped(Mesh mesh, std::size_t triangle) {
  std::swap(mesh.triangles[triangle][1], mesh.triangles[triangle][2]);
  return mesh;
}

/// The triangle again at the end, maybe in the opposite orientation.
inline Mesh with_copy(Mesh mesh, std::size_t triangle, bool opposite) {
  mesh.triangles.push_back(mesh.triangles[triangle]);
  return opposite ? with_flipped(std::move(mesh), mesh.triangles.size() - 1) : mesh;
}

/// The same triangles in another order, each from another corner on.
inline Mesh shuffled(Mesh mesh, unsigned seed) {
  Random random(seed);
  for (std::size_t n = mesh.triangles.size(); n > 1; --n)
    std::swap(mesh.triangles[n - 1], mesh.triangles[random.below(static_cast<std::uint32_t>(n))]);
  for (Triangle& t : mesh.triangles) std::ranges::rotate(t, t.begin() + random.below(3));
  return mesh;
}

}  // namespace standoff::testing
