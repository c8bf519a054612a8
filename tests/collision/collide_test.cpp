// SPDX-License-Identifier: Apache-2.0
// Yes or no against every pair of triangles.
#include <gtest/gtest.h>

#include "standoff/collision.h"
#include "tests/collision/bodies.h"

namespace standoff {
namespace {

using namespace standoff::testing;

void expect_as_brute_force(const Mesh& a, const Mesh& b, int poses, double half, double margin, unsigned seed) {
  const Body model_a(a), model_b(b);
  Random random(seed);
  int hits = 0;
  for (int n = 0; n < poses; ++n) {
    const Pose pose_a = n % 2 ? Pose{} : random_pose(random, half), pose_b = random_pose(random, half);
    const bool expected =
        margin > 0 ? brute_pair_distance(a, pose_a, b, pose_b) <= margin : brute_touch(a, pose_a, b, pose_b);
    const CollisionResult found = collide(model_a, pose_a, model_b, pose_b, {.margin = margin});
    ASSERT_EQ(found.hit(), expected) << "pose " << n;
    ASSERT_EQ(collide(model_b, pose_b, model_a, pose_a, {.margin = margin}).hit(), expected) << "pose " << n;
    hits += expected;
    if (!expected) continue;
    const Corners p = corners_at(a, found.triangle_a, pose_a), q = corners_at(b, found.triangle_b, pose_b);
    ASSERT_TRUE(triangles_intersect(p, q) || closest_points(p, q).distance_sq <= margin * margin);
  }
  EXPECT_GT(hits, poses / 10);
  EXPECT_LT(hits, poses * 9 / 10);
}

TEST(Collide, AgreesWithEveryPairOfTriangles) {
  expect_as_brute_force(ball_mesh(1, 6), ball_mesh(0.7, 4), 300, 1.2, 0, 1);
  expect_as_brute_force(random_soup(3, 300, 1, 0.2), ball_mesh(0.5, 3), 300, 1.2, 0, 2);
  expect_as_brute_force(random_soup(4, 40, 1, 1), random_soup(5, 40, 1, 0.5), 300, 2.5, 0, 3);
}

TEST(Collide, AgreesWithEveryPairWithinAMargin) {
  expect_as_brute_force(ball_mesh(1, 5), ball_mesh(0.5, 3), 200, 1.4, 0.05, 1);
  expect_as_brute_force(random_soup(3, 100, 1, 0.2), ball_mesh(0.5, 3), 200, 2.5, 0.4, 2);
}

TEST(Collide, DegenerateTrianglesCount) {
  expect_as_brute_force(nasty_soup(1, 60, 3), nasty_soup(2, 30, 3), 300, 4, 0, 4);
}

}  // namespace
}  // namespace standoff
