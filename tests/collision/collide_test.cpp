// SPDX-License-Identifier: Apache-2.0
// Yes or no against every pair of triangles.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "standoff/collision.h"
#include "tests/collision/bodies.h"
#include "tests/collision/independent.h"
#include "tests/support/sanitized.h"

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

// Where surfaces run side by side, spheres and fields do not end the search: pairs of oriented boxes do.
TEST(Collide, OfSurfacesThatConform) {
  const Mesh outer = ball_mesh(1, 30), inner = ball_mesh(0.97, 30);
  const Body a(outer), b(inner);
  IndependentBody resting(outer), moving(inner);
  Random random(6);
  int hits = 0;
  for (int n = 0; n < 60; ++n) {
    // The gap is up to 0.0011 less than that of perfect spheres, as edges cut corners.
    Pose pose = random_pose(random, 0);
    const Vec3 away = random.in_cube(1);
    pose.translation = away * (random.between(0.0285, 0.0305) / length(away));
    moving.place(pose);
    const bool expected = moving.touches(resting);
    ASSERT_EQ(collide(a, {}, b, pose).hit(), expected) << "pose " << n;
    ASSERT_EQ(collide(b, pose, a, {}).hit(), expected) << "pose " << n;
    hits += expected;
    const double apart = distance(a, {}, b, pose).upper;
    if (expected) continue;
    EXPECT_FALSE(collide(a, {}, b, pose, {.margin = apart * (1 - 1e-9)}).hit());
    EXPECT_TRUE(collide(a, {}, b, pose, {.margin = apart * (1 + 1e-9)}).hit());
  }
  EXPECT_GT(hits, 10);
  EXPECT_LT(hits, 50);
}

// Slender boxes of a tilted stack: the faces of their own boxes separate them, those along the axes do not.
TEST(Collide, OfBodiesWhoseOrientedBoxesAreApart) {
  const Mesh stack{{{0, 0, 0}, {1, 0, 0}, {0.3, 0.2, 1}},
                   std::vector<Triangle>(kSanitized ? 500 : 3000, Triangle{0, 1, 2})};
  const Body body(stack);
  const double height = 1 / std::sqrt(1.04);  // of a unit step along y
  for (const double step : {1e-3, 0.01, 0.1}) {
    Pose pose;
    pose.translation.y = step;
    EXPECT_FALSE(collide(body, {}, body, pose).hit());
    EXPECT_FALSE(collide(body, {}, body, pose, {.margin = step * height * (1 - 1e-9)}).hit());
    EXPECT_TRUE(collide(body, {}, body, pose, {.margin = step * height * (1 + 1e-9)}).hit());
  }
}

}  // namespace
}  // namespace standoff
