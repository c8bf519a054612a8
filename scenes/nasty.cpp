// SPDX-License-Identifier: Apache-2.0
// Meshes that break careless code. All are legal input.

#include "scenes/families.h"
#include "scenes/random.h"
#include "scenes/scenes.h"

namespace standoff::scenes {
namespace {

void append(Mesh& mesh, const Mesh& other) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const auto& t : other.triangles) mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
}

void append_loose(Mesh& mesh, Vec3 a, Vec3 b, Vec3 c) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), {a, b, c});
  mesh.triangles.push_back({first, first + 1, first + 2});
}

// The n of a sphere of at most so many triangles.
int sphere_n(std::int64_t triangles) {
  int n = 1;
  while (8 * std::int64_t{n + 1} * (n + 1) <= triangles) ++n;
  return n;
}

Vec3 random_point(std::uint64_t key) { return {uniform(key, 0), uniform(key, 1), uniform(key, 2)}; }

Vec3 random_direction(std::uint64_t key) {
  for (std::uint64_t attempt = 0;; ++attempt) {
    const Vec3 p = random_point(hash(key) + attempt) * 2 - Vec3{1, 1, 1};
    const double sq = dot(p, p);
    if (sq > 0.01 && sq <= 1) return p * (1 / std::sqrt(sq));
  }
}

}  // namespace

Mesh make_slivers(std::int64_t triangles) {
  // Lengths about 1, widths from 1e-2 to 1e-8, all directions; every third one is a cap: its apex lies above the middle
  // of its base.
  Mesh mesh;
  for (std::int64_t i = 0; i < triangles; ++i) {
    const auto key = static_cast<std::uint64_t>(i);
    const Vec3 along = random_direction(3 * key), across = normalized(cross(along, random_direction(3 * key + 1)));
    double width = 0.01;
    for (std::uint64_t k = hash(key) % 7; k > 0; --k) width *= 0.1;
    const Vec3 base = random_point(3 * key + 2) * 2;
    append_loose(mesh, base, base + along, base + along * (i % 3 == 0 ? 0.5 : 0.0) + across * width);
  }
  return mesh;
}

Mesh make_degenerate(std::int64_t triangles) {
  // Half a healthy sphere; the rest has no area: points, repeated corners, coincident corners, collinear corners.
  const int n = sphere_n(std::max<std::int64_t>(triangles / 2, 8));
  Mesh mesh = sphere_of(n, {}, 1);
  const auto vertices = static_cast<std::uint32_t>(mesh.vertices.size());
  for (std::int64_t i = 0; static_cast<std::int64_t>(mesh.triangles.size()) < triangles; ++i) {
    const auto key = static_cast<std::uint64_t>(i);
    const auto a = static_cast<std::uint32_t>(hash(2 * key) % vertices);
    const auto b = static_cast<std::uint32_t>(hash(2 * key + 1) % vertices);
    const Vec3 p = mesh.vertices[a] * 1.25, q = mesh.vertices[b] * 1.25;
    switch (i % 6) {
      case 0:
        mesh.triangles.push_back({a, a, a});
        break;
      case 1:
        mesh.triangles.push_back({a, b, a});
        break;
      case 2:
        append_loose(mesh, p, p, p);
        break;
      case 3:
        append_loose(mesh, p, q, q);
        break;
      case 4:
        append_loose(mesh, p, (p + q) * 0.5, q);
        break;
      default:
        append_loose(mesh, p, q, p + (q - p) * 1.5);
        break;
    }
  }
  return mesh;
}

Mesh make_duplicate(std::int64_t triangles) {
  // One sphere four times: as it is, with the same indices again, turned inside out, and on vertices of its own.
  const Mesh once = sphere_of(sphere_n(std::max<std::int64_t>(triangles / 4, 8)), {}, 1);
  Mesh mesh = once;
  mesh.triangles.insert(mesh.triangles.end(), once.triangles.begin(), once.triangles.end());
  for (const auto& t : once.triangles) mesh.triangles.push_back({t[0], t[2], t[1]});
  append(mesh, once);
  return mesh;
}

Mesh make_soup(std::int64_t triangles) {
  // Loose triangles; edges from 1 down to 1/256 of the cube.
  Mesh mesh;
  for (std::int64_t i = 0; i < triangles; ++i) {
    const auto key = static_cast<std::uint64_t>(i);
    double size = 1;
    for (std::uint64_t k = hash(key ^ 0x50u) % 9; k > 0; --k) size *= 0.5;
    const Vec3 a = random_point(4 * key);
    append_loose(mesh, a, a + random_direction(4 * key + 1) * size, a + random_direction(4 * key + 2) * size);
  }
  return mesh;
}

Mesh make_nested(std::int64_t triangles) {
  // Shells inside shells: radii 1, 1/2, ... 1/16, every other one inside out; two of them touch in a point.
  Mesh mesh;
  constexpr int kShells = 5;
  const int n = sphere_n(std::max<std::int64_t>(triangles / (kShells + 1), 8));
  double radius = 1;
  for (int shell = 0; shell < kShells; ++shell, radius *= 0.5) {
    Mesh sphere = sphere_of(n, {}, radius);
    if (shell % 2 == 1)
      for (auto& t : sphere.triangles) std::swap(t[1], t[2]);
    append(mesh, sphere);
  }
  append(mesh, sphere_of(n, {0, 0.75, 0}, 0.25));
  return mesh;
}

Mesh make_open(std::int64_t triangles) {
  // A hemisphere, a tube without ends, a Moebius strip and three sheets on one edge.
  const std::int64_t share = std::max<std::int64_t>(triangles / 4, 8);
  Mesh mesh;
  const std::int64_t pieces = share / 6;  // of the common edge of the sheets
  const Mesh sphere = sphere_of(std::max(1, sphere_n(2 * share)), {}, 1);
  mesh.vertices = sphere.vertices;
  mesh.triangles.assign(sphere.triangles.begin(), sphere.triangles.begin() + sphere.triangles.size() / 2);
  const auto band = [&](std::int64_t count, bool twisted, auto&& point) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (std::int64_t i = 0; i < count; ++i)
      for (int side = 0; side < 2; ++side)
        mesh.vertices.push_back(point(static_cast<double>(i) / static_cast<double>(count), side));
    for (std::int64_t i = 0; i < count; ++i) {
      const bool wraps = i + 1 == count;
      const auto a = first + static_cast<std::uint32_t>(2 * i), b = wraps ? first : a + 2;
      const std::uint32_t low = wraps && twisted ? 1 : 0, high = 1 - low;
      mesh.triangles.push_back({a, b + low, b + high});
      mesh.triangles.push_back({a, b + high, a + 1});
    }
  };
  // The bands take what the hemisphere and the sheets leave; three pieces are the fewest that go around.
  const std::int64_t left = (triangles - static_cast<std::int64_t>(mesh.triangles.size()) - 6 * pieces) / 2;
  band(std::max<std::int64_t>(3, left / 2), false, [](double t, int side) {
    const auto [c, s] = circle(t);
    return Vec3{2.5 + 0.5 * c, side * 1.5, 0.5 * s};
  });
  band(std::max<std::int64_t>(3, left - left / 2), true, [](double t, int side) {
    const auto [c, s] = circle(t);
    const auto [hc, hs] = circle(t / 2);
    const double offset = side - 0.5;
    return Vec3{c * (1 + offset * hc), -1.5 + offset * hs, s * (1 + offset * hc)};
  });
  // The sheets share the vertices of their common edge: every edge on it has three triangles.
  const auto spine = static_cast<std::uint32_t>(mesh.vertices.size());
  const auto along = [&](std::int64_t i) { return 2.0 * static_cast<double>(i) / static_cast<double>(pieces) - 1; };
  for (std::int64_t i = 0; i <= pieces; ++i) mesh.vertices.push_back({2.5, -1.5, along(i)});
  for (int sheet = 0; sheet < 3; ++sheet) {
    const auto [c, s] = circle(sheet / 3.0);
    const auto outer = static_cast<std::uint32_t>(mesh.vertices.size());
    for (std::int64_t i = 0; i <= pieces; ++i) mesh.vertices.push_back({2.5 + c, -1.5 + s, along(i)});
    for (std::uint32_t i = 0; i < pieces; ++i) {
      mesh.triangles.push_back({spine + i, spine + i + 1, outer + i + 1});
      mesh.triangles.push_back({spine + i, outer + i + 1, outer + i});
    }
  }
  return mesh;
}

Mesh make_one_triangle(std::int64_t triangles) {
  Mesh mesh{{{0, 0, 0}, {3, 0.5, 0}, {1, 2, 1.5}}, {{0, 1, 2}}};
  split_to(mesh, triangles);
  return mesh;
}

Mesh make_far_away(std::int64_t triangles) {
  Mesh mesh = make("fly", triangles);
  for (auto& v : mesh.vertices) v = v + Vec3{1e6, -1e6, 1e6};
  return mesh;
}

Mesh make_tiny(std::int64_t triangles) {
  Mesh mesh = make("fly", triangles);
  for (auto& v : mesh.vertices) v = v * 1e-6;
  return mesh;
}

}  // namespace standoff::scenes
