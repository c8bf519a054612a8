// SPDX-License-Identifier: Apache-2.0
// Distances against every pair of triangles.
#include <gtest/gtest.h>

#include "standoff/collision.h"
#include "tests/collision/bodies.h"
#include "tests/collision/zoo/gap.h"
#include "tests/collision/zoo/slivers.h"

namespace standoff {
namespace {

using namespace standoff::testing;

void expect_as_brute_force(const Mesh& a, const Mesh& b, int poses, double half, unsigned seed) {
  const CollisionModel model_a(a), model_b(b);
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

// Needles that touch: the point was computed from their normals, and off by up to 1,400 roundings of a coordinate.
TEST(Distance, PointsOfTouchingNeedlesLieOnThem) {
  Random random(5);
  int touching = 0;
  double worst = 0;
  for (int n = 0; n < 1500; ++n) {
    const SliverPair pair =
        sliver_pair(random, log_between(random, 1e-3, 1e-1), Thin::any_way, TriangleOverlap::touching);
    Mesh a, b;
    add_triangle(a, pair.p[0], pair.p[1], pair.p[2]);
    add_triangle(b, pair.q[0], pair.q[1], pair.q[2]);
    const ModelOptions coarse{.spacing = 0.5, .execution = {.threads = 1}};
    const DistanceResult found = distance(CollisionModel(a, coarse), {}, CollisionModel(b, coarse), {});
    touching += found.upper == 0;
    double coordinate = 0;
    for (int k = 0; k < 3; ++k) coordinate = std::max({coordinate, max_norm(pair.p[k]), max_norm(pair.q[k])});
    worst = std::max({worst, root_of(point_triangle_sq(found.point_a, pair.p)) / coordinate,
                      root_of(point_triangle_sq(found.point_b, pair.q)) / coordinate});
  }
  EXPECT_LE(worst, 8 * 0x1p-53);
  EXPECT_GT(touching, 500);
}

TEST(Distance, FarBodies) { expect_as_brute_force(ball_mesh(1, 3), ball_mesh(0.5, 2), 20, 1000, 4); }

}  // namespace
}  // namespace standoff
