// SPDX-License-Identifier: Apache-2.0
// The method tiles where the distance is known in closed form.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <numbers>

#include "standoff/compute.h"
#include "tests/support/fields.h"
#include "tests/support/random_mesh.h"

namespace standoff::testing {
namespace {

template <class DistanceResult>
void expect_field(const Mesh& mesh, const Grid& grid, DistanceResult distance) {
  for (const double thickness : {1.1, 6.3, kInfinity}) {
    const DistanceField field = computed(mesh, grid, thickness).field;
    for_each_sample(grid, [&](auto i, auto j, auto k) {
      const double expected = std::min(distance(grid.position(i, j, k)), thickness);
      ASSERT_NEAR(field.value(i, j, k), expected, promised_error(grid, expected)) << i << ' ' << j << ' ' << k;
    });
  }
}

const Grid kClosedFormGrid{{21, 20, 19}, {-5, -4.9, -4.4}, {0.5, 0.5, 0.5}};

void add_quad(Mesh& mesh, Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
  add_triangle(mesh, a, b, c);
  add_triangle(mesh, a, c, d);
}

TEST(TilesClosedForm, Plane) {
  Mesh mesh;
  add_quad(mesh, {-100, -100, 0.3}, {100, -100, 0.3}, {100, 100, 0.3}, {-100, 100, 0.3});
  expect_field(mesh, kClosedFormGrid, [](Vec3 p) { return std::abs(p.z - 0.3); });
}

TEST(TilesClosedForm, Box) {
  const Vec3 h{2.2, 1.3, 3.1};
  Mesh mesh;
  for (const double s : {-1.0, 1.0}) {
    add_quad(mesh, {s * h.x, -h.y, -h.z}, {s * h.x, h.y, -h.z}, {s * h.x, h.y, h.z}, {s * h.x, -h.y, h.z});
    add_quad(mesh, {-h.x, s * h.y, -h.z}, {h.x, s * h.y, -h.z}, {h.x, s * h.y, h.z}, {-h.x, s * h.y, h.z});
    add_quad(mesh, {-h.x, -h.y, s * h.z}, {h.x, -h.y, s * h.z}, {h.x, h.y, s * h.z}, {-h.x, h.y, s * h.z});
  }
  expect_field(mesh, kClosedFormGrid, [&](Vec3 p) {
    const Vec3 q = Vec3{std::abs(p.x), std::abs(p.y), std::abs(p.z)} - h;
    const double inside = std::max({q.x, q.y, q.z});
    return inside > 0 ? length(max(q, Vec3{})) : -inside;
  });
}

TEST(TilesClosedForm, SegmentAndPoint) {
  const Vec3 a{-2, -1, 0.5}, b{3, 2, -1};
  const auto to_segment = [&](Vec3 p) {
    const double t = std::clamp(dot(p - a, b - a) / dot(b - a, b - a), 0.0, 1.0);
    return length(p - (a + (b - a) * t));
  };
  Mesh segment, with_middle, point;
  add_triangle(segment, a, b, b);
  add_triangle(with_middle, a, (a + b) * 0.5, b);
  add_triangle(point, a, a, a);
  expect_field(segment, kClosedFormGrid, to_segment);
  expect_field(with_middle, kClosedFormGrid, to_segment);
  expect_field(point, kClosedFormGrid, [&](Vec3 p) { return length(p - a); });
}

TEST(TilesClosedForm, SphereBetweenItsTrianglesAndItself) {
  // A polyhedron with corners on the sphere lies between it and a sphere smaller by the deepest sagitta.
  constexpr double kRadius = 3;
  constexpr int kRings = 24, kTurns = 48;
  const auto at = [](int ring, int turn) {
    const double polar = std::numbers::pi * ring / kRings, around = 2 * std::numbers::pi * turn / kTurns;
    return Vec3{std::sin(polar) * std::cos(around), std::sin(polar) * std::sin(around), std::cos(polar)} * kRadius;
  };
  Mesh mesh;
  double least_radius = kRadius;
  for (int ring = 0; ring < kRings; ++ring)
    for (int turn = 0; turn < kTurns; ++turn) {
      add_quad(mesh, at(ring, turn), at(ring + 1, turn), at(ring + 1, turn + 1), at(ring, turn + 1));
      for (int t = 0; t < 2; ++t)
        least_radius = std::min(least_radius, reference_distance(mesh, mesh.triangles.size() - 1 - t, Vec3{}));
    }
  ASSERT_GT(least_radius, 0.98 * kRadius);
  const DistanceField field = computed(mesh, kClosedFormGrid, kInfinity).field;
  for_each_sample(kClosedFormGrid, [&](auto i, auto j, auto k) {
    const double r = length(kClosedFormGrid.position(i, j, k)), value = field.value(i, j, k),
                 slack = promised_error(kClosedFormGrid, r);
    const double low = r > kRadius ? r - kRadius : std::max(least_radius - r, 0.0);
    const double high = r > kRadius ? r - least_radius : std::max(kRadius - r, kRadius - least_radius);
    ASSERT_GE(value, low - slack);
    ASSERT_LE(value, high + slack);
  });
}

TEST(TilesClosedForm, OneTriangleInAllOrdersOfItsCorners) {
  // In the plane z = 0.25 by its regions; the right angle at the first corner makes them plain.
  const Vec3 corner[] = {{-1, -1, 0.25}, {3, -1, 0.25}, {-1, 2, 0.25}};
  const auto distance = [](Vec3 p) {
    const double x = p.x + 1, y = p.y + 1, z = p.z - 0.25;  // legs 4 and 3
    const double across = (3 * x + 4 * y - 12) / 5, along = std::clamp((-4 * (x - 4) + 3 * y) / 5, 0.0, 5.0);
    if (x >= 0 && y >= 0 && across <= 0) return std::abs(z);
    const double to_x = std::hypot(x - std::clamp(x, 0.0, 4.0), y), to_y = std::hypot(x, y - std::clamp(y, 0.0, 3.0)),
                 to_hypotenuse = std::hypot(x - (4 - 0.8 * along), y - 0.6 * along);
    return std::hypot(std::min({to_x, to_y, to_hypotenuse}), z);
  };
  std::array<int, 3> order{0, 1, 2};
  do {
    Mesh mesh;
    add_triangle(mesh, corner[order[0]], corner[order[1]], corner[order[2]]);
    expect_field(mesh, kClosedFormGrid, distance);
  } while (std::ranges::next_permutation(order).found);
}

}  // namespace
}  // namespace standoff::testing
