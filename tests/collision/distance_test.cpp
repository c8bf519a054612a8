// SPDX-License-Identifier: Apache-2.0
// Distances against every pair of triangles.
#include <gtest/gtest.h>

#include <numbers>

#include "standoff/collision.h"
#include "tests/collision/bodies.h"
#include "tests/collision/zoo/gap.h"
#include "tests/collision/zoo/slivers.h"
#include "tests/support/sanitized.h"

namespace standoff {
namespace {

using namespace standoff::testing;

void expect_as_brute_force(const Mesh& a, const Mesh& b, int poses, double half, unsigned seed) {
  const Body model_a(a), model_b(b);
  Random random(seed);
  for (int n = 0; n < poses; ++n) {
    const Pose pose_a = n % 2 ? Pose{} : random_pose(random, half), pose_b = random_pose(random, half);
    const double expected = brute_pair_distance(a, pose_a, b, pose_b);
    const double allowed = 1e-12 * (1 + expected);
    const DistanceResult found = distance(model_a, pose_a, model_b, pose_b);
    ASSERT_NEAR(found.upper, expected, allowed) << "pose " << n;
    ASSERT_EQ(found.lower, found.upper);
    ASSERT_NEAR(length(found.point_a - found.point_b), expected, allowed);
    const Corners p = corners_at(a, found.triangle_a, pose_a), q = corners_at(b, found.triangle_b, pose_b);
    ASSERT_NEAR(expected > 0 ? std::sqrt(closest_points(p, q).distance_sq) : 0, expected, allowed);
    const DistanceResult turned = distance(model_b, pose_b, model_a, pose_a);
    ASSERT_NEAR(turned.upper, expected, allowed);
    for (const double tolerance : {0.01, 0.3}) {
      const DistanceResult rough = distance(model_a, pose_a, model_b, pose_b, {.tolerance = tolerance});
      ASSERT_LE(rough.lower, expected + allowed);
      ASSERT_GE(rough.upper, expected - allowed);
      ASSERT_LE(rough.upper - rough.lower, tolerance + allowed);
    }
    const DistanceResult limited = distance(model_a, pose_a, model_b, pose_b, {.limit = 0.5 * expected});
    ASSERT_TRUE(expected == 0 || limited.upper == std::numeric_limits<double>::infinity());
    ASSERT_EQ(limited.lower, 0.5 * expected);
  }
}

TEST(Distance, AgreesWithEveryPairOfTriangles) {
  expect_as_brute_force(ball_mesh(1, 5), ball_mesh(0.5, 3), 100, 2, 1);
  expect_as_brute_force(random_soup(3, 100, 1, 0.2), ball_mesh(0.5, 3), 100, 2, 2);
  expect_as_brute_force(random_soup(3, 20, 1, 0.9), random_soup(4, 20, 1, 0.5), 200, 5, 3);
}

// Needles that touch: the point was once computed from their normals, with an error of up to 1,400 roundings of a
// coordinate.
TEST(Distance, PointsOfTouchingNeedlesLieOnThem) {
  Random random(5);
  int touching = 0;
  double worst = 0;
  constexpr int kPairs = kSanitized ? 150 : 1500;
  for (int n = 0; n < kPairs; ++n) {
    const SliverPair pair =
        sliver_pair(random, log_between(random, 1e-3, 1e-1), Thin::any_way, TriangleOverlap::touching);
    Mesh a, b;
    add_triangle(a, pair.p[0], pair.p[1], pair.p[2]);
    add_triangle(b, pair.q[0], pair.q[1], pair.q[2]);
    const BodyOptions coarse{.spacing = 0.5, .execution = {.threads = 1}};
    const DistanceResult found = distance(Body(a, coarse), {}, Body(b, coarse), {});
    touching += found.upper == 0;
    double coordinate = 0;
    for (int k = 0; k < 3; ++k) coordinate = std::max({coordinate, max_norm(pair.p[k]), max_norm(pair.q[k])});
    worst = std::max({worst, root_of(point_triangle_sq(found.point_a, pair.p)) / coordinate,
                      root_of(point_triangle_sq(found.point_b, pair.q)) / coordinate});
  }
  EXPECT_LE(worst, 8 * 0x1p-53);
  EXPECT_GT(touching, kPairs / 3);
}

// Bodies with very many pairs that are equally near: they took up to 46 s, because no bound drops any of them.
Mesh fan(int triangles) {
  Mesh mesh{{{0, 0, 0}}, {}};
  for (int n = 0; n < triangles; ++n) {
    const double angle = 2 * std::numbers::pi * n / triangles;
    mesh.vertices.push_back({std::cos(angle), std::sin(angle), 1});
  }
  for (std::uint32_t n = 0; n < mesh.vertices.size() - 1; ++n)
    mesh.triangles.push_back({0, 1 + n, 1 + (n + 1) % static_cast<std::uint32_t>(triangles)});
  return mesh;
}
Mesh plate(int cuts) {
  Mesh mesh;
  for (double x = 0; x < cuts; ++x)
    for (double y = 0; y < cuts; ++y) {
      add_triangle(mesh, {x, y, 0}, {x + 1, y, 0}, {x, y + 1, 0});
      add_triangle(mesh, {x + 1, y, 0}, {x + 1, y + 1, 0}, {x, y + 1, 0});
    }
  return mesh;
}
TEST(Distance, OfManyEquallyNearPairsIsTheirs) {
  const Body cone(fan(5000));
  EXPECT_NEAR(distance(cone, {}, cone, make_pose({1, 0, 0}, std::numbers::pi, {0, 0, -0.1})).upper, 0.1, 1e-15);
  const Body flat(plate(60));
  for (const double angle : {0.0, 0.3, 2.0})
    EXPECT_NEAR(distance(flat, {}, flat, make_pose({0, 0, 1}, angle, {3, 2, 1e-3})).upper, 1e-3, 1e-15);
  Mesh copies{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {}};
  copies.triangles.assign(5000, {0, 1, 2});
  const Body same(copies);
  EXPECT_NEAR(distance(same, {}, same, moved({0.2, 0.1, 1})).upper, 1, 1e-15);
}
// A gap that a plane proves must not be taken for the distance of bodies that the plane does not touch.
TEST(Distance, OfNestedSurfacesAgreesWithEveryPair) {
  constexpr int kPoses = kSanitized ? 3 : 30;
  expect_as_brute_force(ball_mesh(1, 6), ball_mesh(0.9, 6), kPoses, 0.03, 6);
  expect_as_brute_force(ball_mesh(1, 6), ball_mesh(1.1, 5), kPoses, 0.03, 7);
}
TEST(Collide, NestedSurfacesTouchWhereAPairDoes) {
  const Mesh outer = ball_mesh(1, 9), inner = ball_mesh(0.97, 9);
  const Body a(outer), b(inner);
  Random random(8);
  int hits = 0;
  for (int n = 0; n < 60; ++n) {
    const Pose pose = random_pose(random, 0.02);
    const bool expected = brute_touch(outer, {}, inner, pose);
    EXPECT_EQ(collide(a, {}, b, pose).hit(), expected);
    hits += expected;
  }
  EXPECT_TRUE(hits > 5 && hits < 55);
}

TEST(Distance, FarBodies) { expect_as_brute_force(ball_mesh(1, 3), ball_mesh(0.5, 2), 20, 1000, 4); }

}  // namespace
}  // namespace standoff
