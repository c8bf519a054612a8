// SPDX-License-Identifier: Apache-2.0
#include "standoff/points.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/random_mesh.h"
#include "tests/support/reference.h"

namespace standoff::testing {
namespace {

// Compares with brute force over all triangles, by another formula; then checks that the members agree.
void expect_closest(const Mesh& mesh, std::span<const Vec3> points, double size) {
  const std::vector<ClosestPoint> found = closest_points(mesh, points);
  ASSERT_EQ(found.size(), points.size());
  const double rounding = 1e-12 * size;
  for (std::size_t n = 0; n < points.size(); ++n) {
    const ClosestPoint& it = found[n];
    ASSERT_LT(it.triangle, mesh.triangles.size());
    EXPECT_NEAR(it.distance, reference_distance(mesh, points[n]), rounding);
    EXPECT_NEAR(length(it.point - points[n]), it.distance, rounding);
    Vec3 weighed;
    double sum = 0;
    for (int k = 0; k < 3; ++k) {
      EXPECT_GE(it.barycentric[k], 0);
      EXPECT_LE(it.barycentric[k], 1);
      sum += it.barycentric[k];
      weighed = weighed + mesh.vertices[mesh.triangles[it.triangle][k]] * it.barycentric[k];
    }
    EXPECT_NEAR(sum, 1, 1e-15);
    EXPECT_NEAR(length(weighed - it.point), 0, rounding);
  }
}

TEST(ClosestPoints, OfASoupAreThoseOfBruteForce) {
  expect_closest(random_soup(11, 500, 4, 1), points_around(1, 300, 8), 8);
}

TEST(ClosestPoints, FarFromTheOrigin) {
  Mesh mesh = random_soup(12, 100, 4, 1);
  const Vec3 at{1e6, -2e6, 3e5};
  for (Vec3& v : mesh.vertices) v = v + at;
  std::vector<Vec3> points = points_around(2, 100, 6);
  for (Vec3& p : points) p = p + at;
  expect_closest(mesh, points, 1e4);  // a double resolves 4e-10 there
}

TEST(ClosestPoints, OfDegenerateTriangles) {
  const Mesh mesh{{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 0, 3}, {1, 1e-9, 3}, {2, 0, 3}},
                  {{0, 1, 2}, {0, 0, 0}, {3, 4, 5}, {1, 1, 2}}};
  expect_closest(mesh, points_around(3, 200, 4), 4);
}

TEST(ClosestPoints, FaceSideAndCorner) {
  const Mesh mesh{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {{0, 1, 2}}};
  const std::vector<Vec3> points{{1, 1, 2}, {1, -3, 0}, {-3, -4, 0}, {1, 1, 0}};
  const auto found = closest_points(mesh, points);
  EXPECT_EQ(found[0].distance, 2);
  EXPECT_EQ(found[0].point, (Vec3{1, 1, 0}));
  EXPECT_EQ(found[0].barycentric, (std::array<double, 3>{0.5, 0.25, 0.25}));
  EXPECT_EQ(found[1].distance, 3);
  EXPECT_EQ(found[1].barycentric, (std::array<double, 3>{0.75, 0.25, 0}));
  EXPECT_EQ(found[2].distance, 5);
  EXPECT_EQ(found[2].barycentric, (std::array<double, 3>{1, 0, 0}));
  EXPECT_EQ(found[3].distance, 0);
}

// Every triangle occurs twice, the copies in another order.
TEST(ClosestPoints, OfEquallyNearTrianglesTheLowest) {
  Mesh mesh = random_soup(13, 200, 4, 1);
  const std::vector<Triangle> once = mesh.triangles;
  mesh.triangles.insert(mesh.triangles.end(), once.rbegin(), once.rend());
  for (const ClosestPoint& it : closest_points(mesh, points_around(4, 200, 6))) EXPECT_LT(it.triangle, once.size());
}

TEST(ClosestPoints, AreTheSameForAnyNumberOfThreads) {
  const Mesh mesh = random_soup(14, 300, 4, 1);
  const std::vector<Vec3> points = points_around(5, 500, 6);
  const auto one = closest_points(mesh, points, {.execution = {.threads = 1}}),
             many = closest_points(mesh, points, {.execution = {.threads = 7}});
  for (std::size_t n = 0; n < points.size(); ++n) {
    EXPECT_EQ(one[n].distance, many[n].distance);
    EXPECT_EQ(one[n].point, many[n].point);
    EXPECT_EQ(one[n].triangle, many[n].triangle);
    EXPECT_EQ(one[n].barycentric, many[n].barycentric);
  }
}

TEST(ClosestPoints, NoneForNoPoints) { EXPECT_TRUE(closest_points(random_soup(15, 3, 1, 1), {}).empty()); }

}  // namespace
}  // namespace standoff::testing
