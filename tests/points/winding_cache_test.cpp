// SPDX-License-Identifier: Apache-2.0
// Compares winding numbers that the cache continues from known points with the number of a ray from each point.
#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "points/point_sign.h"
#include "points/triangle_index.h"
#include "simd/dispatch.h"
#include "standoff/points.h"
#include "tests/sign/shapes.h"

namespace standoff::testing {
namespace {

struct Case {
  const char* name;
  Mesh mesh;
};

// Points of a lattice are on its slanted faces.
Mesh octahedron() {
  return {{{1.5, 0, 0}, {-1.5, 0, 0}, {0, 1.5, 0}, {0, -1.5, 0}, {0, 0, 1.5}, {0, 0, -1.5}},
          {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}}};
}

std::vector<Case> cases() {
  return {{"a box within a box", joined(box({-1, -1, -1}, {1, 1, 1}), box({-0.5, -0.5, -0.5}, {0.5, 0.5, 0.25}))},
          {"ball", sphere(10)},
          {"octahedron", octahedron()}};
}

// Random points, and points whose rows pass through corners and edges.
std::vector<Vec3> points_around(unsigned seed) {
  Random random(seed);
  std::vector<Vec3> points;
  const auto quarter = [&] { return 0.25 * random.below(13) - 1.5; };
  for (int n = 0; n < 300; ++n) {
    points.push_back(random.in_cube(1.5));
    points.push_back({quarter(), quarter(), quarter()});
  }
  return points;
}

const cpu::PointKernels& kernels() { return dispatch_of<cpu::PointKernels>().best(); }

TEST(WindingCache, ByRows) {
  for (const auto& [name, mesh] : cases()) {
    SCOPED_TRACE(name);
    const TriangleIndex index(mesh, {}, 1, Simd::automatic);
    const RayWinding rays({mesh}, index);
    WindingCache known(rays, kernels());
    const std::vector<Vec3> points = points_around(1);
    const auto by_ray = [&](const Vec3& at) { return rays.at(at, kernels()); };
    const auto none = [](const Vec3&) { return -77; };
    EXPECT_EQ(known.by_rows(points[0], 1e9, none), -77);  // nothing is known yet
    known.in_ball(points[0], 0, by_ray);
    int of_number[3] = {};
    for (const Vec3& at : points) {
      const std::int32_t winding = by_ray(at);
      ++of_number[winding];
      EXPECT_EQ(known.by_rows(at), winding) << at.x << ' ' << at.y << ' ' << at.z;
      EXPECT_EQ(known.by_rows(at, 1e9, none), winding);
      EXPECT_EQ(known.by_rows(at, 0, none), -77);
      known.in_ball(at, 0, by_ray);
    }
    EXPECT_GT(of_number[0], 100);
    EXPECT_GT(of_number[1], 50);
  }
}

TEST(WindingCache, OnRow) {
  constexpr std::int32_t kNone = 99;
  const auto none = [](const Vec3&) { return kNone; };
  for (const auto& [name, mesh] : cases()) {
    SCOPED_TRACE(name);
    const TriangleIndex index(mesh, {}, 1, Simd::automatic);
    const RayWinding rays({mesh}, index);
    WindingCache known(rays, kernels());
    const std::vector<Vec3> points = points_around(2);
    std::vector<double> free(points.size());
    MeshQuery(mesh, {.sign = {SignMethod::none}}).distances(points, free);
    const auto by_ray = [&](const Vec3& at) { return rays.at(at, kernels()); };
    EXPECT_EQ(known.on_row(points[0], none), kNone);
    int found = 0, different = 0;
    for (std::size_t n = 0; n < points.size(); ++n) {
      const Vec3& at = points[n];
      const std::int32_t winding = by_ray(at), told = known.on_row(at, none);
      if (told != kNone) {
        EXPECT_EQ(told, winding) << at.x << ' ' << at.y << ' ' << at.z;
        ++found;
        different += n != 0 && winding != by_ray(points[n - 1]);
      }
      EXPECT_EQ(known.in_ball(at, free[n], by_ray), winding);
    }
    EXPECT_GT(found, 200);
    EXPECT_GT(different, 50);
    EXPECT_EQ(known.on_row({1e3, -1e3, 2e3}, none), kNone);
  }
}

}  // namespace
}  // namespace standoff::testing
