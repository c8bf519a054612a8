// SPDX-License-Identifier: Apache-2.0
// Closest triangles against all triangles, one by one.
#include "sign/normal/normal_signs.h"

#include <gtest/gtest.h>

#include "tests/sign/shapes.h"
#include "tests/support/closest_of_all.h"

namespace standoff::testing {
namespace {

void expect_closest(const Mesh& mesh, Random& random, double half, Vec3 center = {}) {
  const ClosestTriangle closest(mesh);
  for (int n = 0; n < 200; ++n) {
    const Vec3 p = center + random.in_cube(half);
    const std::uint32_t found = closest.to(p);
    ASSERT_LT(found, mesh.triangles.size());
    const double least = brute_distance(mesh, p);
    EXPECT_LE(triangle_distance(mesh, found, p), least * (1 + 1e-15)) << mesh.triangles.size();
  }
}

TEST(ClosestTriangle, OfSoupsOfAnySizeInAnyOrder) {
  for (const int triangles : {1, 2, 15, 16, 17, 64, 65, 257, 1025, 3000})
    for (const double side : {0.0, 0.01, 0.5}) {
      Random random(static_cast<unsigned>(triangles));
      expect_closest(random_soup(5, triangles, 1, side), random, 2);
      const Vec3 far{1e6, -2e6, 3e6};
      expect_closest(random_soup(6, triangles, 1, side, far), random, 2, far);
    }
}

TEST(ClosestTriangle, OfFlatMeshesAndOfOnePoint) {
  Random random(1);
  const Mesh flat = terrain(20, 0), point = random_soup(2, 40, 0, 0);
  expect_closest(flat, random, 3);
  expect_closest(point, random, 3);
}

TEST(ClosestTriangle, OfManyThatAreEquallyClose) {
  const Mesh once = random_soup(3, 50, 1, 0.2);
  Mesh mesh = once;
  for (int n = 0; n < 20; ++n)
    mesh.triangles.insert(mesh.triangles.end(), once.triangles.begin(), once.triangles.end());
  Random random(4);
  expect_closest(mesh, random, 2);
}

TEST(ClosestTriangle, OfNoTriangles) { EXPECT_EQ(ClosestTriangle(Mesh{}).to({1, 2, 3}), kNoTriangle); }

}  // namespace
}  // namespace standoff::testing
