// SPDX-License-Identifier: Apache-2.0
// Distances that end after some number of steps: what they have proven, against every pair of triangles.
#include <gtest/gtest.h>

#include <cmath>

#include "standoff/collision.h"
#include "tests/collision/bodies.h"
#include "tests/collision/expect_same.h"
#include "tests/support/expect_error.h"
#include "tests/support/sanitized.h"

namespace standoff {
namespace {

using namespace standoff::testing;

constexpr std::int64_t kNever = 100'000;  // steps that no query of these bodies needs

// The bodies of a query and their distance by brute force.
struct Query {
  Body a, b;
  Pose pose_a, pose_b;
  double expected;

  Query(const Mesh& mesh_a, const Pose& at_a, const Mesh& mesh_b, const Pose& at_b)
      : a(mesh_a), b(mesh_b), pose_a(at_a), pose_b(at_b), expected(brute_pair_distance(mesh_a, at_a, mesh_b, at_b)) {}
  DistanceResult ask(const DistanceOptions& options) const { return distance(a, pose_a, b, pose_b, options); }
};

// Bounds hold after each number of steps, the lower one never falls, and only the whole answer is finished. Returns the
// steps of a query that is finished.
std::int64_t expect_bounds_after_any_steps(const Query& query) {
  const double allowed = 1e-12 * (1 + query.expected);
  const DistanceResult whole = query.ask({});
  EXPECT_TRUE(whole.finished);
  double lower = 0;
  for (std::int64_t steps = 1; steps < kNever; ++steps) {
    const DistanceResult found = query.ask({.max_steps = steps});
    EXPECT_LE(found.lower, query.expected + allowed) << steps;
    EXPECT_GE(found.upper, query.expected - allowed) << steps;
    EXPECT_LE(found.lower, found.upper);
    EXPECT_GE(found.lower, lower) << steps;
    EXPECT_NEAR(length(found.point_a - found.point_b), found.upper, allowed);
    lower = found.lower;
    if (!found.finished) continue;
    expect_same(found, whole);
    expect_same(query.ask({.max_steps = kNever}), whole);
    return steps;
  }
  ADD_FAILURE() << "not finished after " << kNever << " steps";
  return kNever;
}

void expect_bounds_of_poses(const Mesh& a, const Mesh& b, int poses, double half, unsigned seed) {
  Random random(seed);
  for (int n = 0; n < poses; ++n)
    expect_bounds_after_any_steps({a, n % 2 ? Pose{} : random_pose(random, half), b, random_pose(random, half)});
}

TEST(DistanceSteps, BoundsHoldAfterAnyNumber) {
  expect_bounds_of_poses(random_soup(3, 100, 1, 0.2), random_soup(4, 60, 1, 0.3), 12, 2, 1);
  expect_bounds_of_poses(random_soup(5, 20, 1, 0.9), random_soup(6, 20, 1, 0.5), 20, 5, 2);
  expect_bounds_of_poses(ball_mesh(1, 5), random_soup(7, 40, 0.5, 0.2), 12, 2, 3);
  expect_bounds_of_poses(one_triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}), ball_mesh(0.3, 3), 12, 1, 4);
}

TEST(DistanceSteps, BoundsOfNestedSurfacesHold) {
  Random random(5);
  for (int n = 0; n < (kSanitized ? 1 : 4); ++n)
    expect_bounds_after_any_steps({ball_mesh(1, 6), {}, ball_mesh(0.9, 6), random_pose(random, 0.03)});
}

TEST(DistanceSteps, BoundsHoldWithAToleranceAndALimit) {
  Random random(6);
  const Mesh a = random_soup(8, 100, 1, 0.2), b = random_soup(9, 60, 1, 0.3);
  for (int n = 0; n < 20; ++n) {
    const Query query(a, {}, b, random_pose(random, 2));
    const double allowed = 1e-12 * (1 + query.expected);
    for (std::int64_t steps = 1; steps < 400; steps += 7)
      for (const double limit : {0.5 * query.expected, 1.1 * query.expected})
        for (const double tolerance : {0.0, 0.05}) {
          const DistanceResult found = query.ask({tolerance, limit, steps});
          ASSERT_LE(found.lower, query.expected + allowed);
          ASSERT_GE(found.upper, query.expected - allowed);
          ASSERT_TRUE(!found.finished || !(found.lower + tolerance + allowed < std::min(limit, found.upper)));
        }
  }
}

// A tolerance once shortened the limit, but not the lower bound that a query returned at the limit.
TEST(Distance, IsLookedForUpToTheLimitWithAnyTolerance) {
  const Body body(one_triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}));
  const DistanceResult found = distance(body, {}, body, moved({0, 0, 0.95}), {.tolerance = 0.1, .limit = 1});
  EXPECT_NEAR(found.upper, 0.95, 1e-15);
  EXPECT_LE(found.lower, 0.95);
}

// All nine million pairs are equally near, and rounding turns the direction between their closest points: only the
// triangles' normals prove it. Each pair was measured.
TEST(DistanceSteps, TiltedStacksNeedNotEachPair) {
  const Body stack(Mesh{{{0, 0, 0}, {1, 0, 0}, {0.3, 0.2, 1}}, std::vector<Triangle>(3000, Triangle{0, 1, 2})});
  Pose above;
  above.translation = {0, 0.01, 0};
  const DistanceResult found = distance(stack, {}, stack, above, {.max_steps = kNever});
  EXPECT_TRUE(found.finished);
  EXPECT_NEAR(found.upper, 0.01 / std::sqrt(1.04), 1e-15);
}

TEST(DistanceSteps, MustNotBeNegative) {
  const Body body(ball_mesh(1, 2));
  expect_error(
      [&] {
        distance(body, {}, body, moved({3, 0, 0}), {.max_steps = -1});
      },
      ErrorCode::usage, "distance: max_steps must not be negative; give 0 for no limit");
}

}  // namespace
}  // namespace standoff
