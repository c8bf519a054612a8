// SPDX-License-Identifier: Apache-2.0
// Sweeps along cubic curves: known times, and exact queries at many times of them.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "standoff/collision.h"
#include "tests/collision/bodies.h"

namespace standoff {
namespace {

using namespace standoff::testing;

// A curve through the heights of a parabola: x from -1 to 1, z lowest in its middle, at `lowest`.
SplineMotion arc(double lowest) {
  SplineMotion motion;
  const double above = lowest + 1, third = lowest - 1.0 / 3;  // z = lowest + (2 t - 1)^2
  motion.start = moved({-1, 0, above});
  motion.control = {Vec3{-1.0 / 3, 0, third}, Vec3{1.0 / 3, 0, third}, Vec3{1, 0, above}};
  return motion;
}

TEST(SweepSpline, MissNoContact) {
  const Body ball(ball_mesh(1, 3)), soup(random_soup(3, 40, 1, 0.5)), small(random_soup(4, 15, 0.3, 0.4)),
      tiny(random_soup(5, 15, 0.05, 0.06));
  struct Pair {
    const Body &a, &b;
  };
  constexpr double kTolerance = 1e-3;
  constexpr int kTimes = 2000;
  Random random(51);
  for (const Pair& pair :
       {Pair{ball, small}, Pair{soup, small}, Pair{small, soup}, Pair{ball, tiny}, Pair{tiny, ball}}) {
    int hits = 0, frees = 0;
    for (int n = 0; n < 40; ++n) {
      SCOPED_TRACE("case " + std::to_string(n));
      const Pose pose_a = n % 2 == 0 ? Pose{} : random_pose(random, 0.5);
      SplineMotion motion{.start = random_pose(random, 4), .center = random.in_cube(0.5)};
      for (Vec3& point : motion.control) point = random.in_cube(4);
      if (n % 4 != 0) motion.axis = random.in_cube(1) + Vec3{1e-3, 0, 0}, motion.angle_rad = random.between(-12, 12);
      const SweepResult swept = sweep_spline(pair.a, pose_a, pair.b, motion, {.tolerance = kTolerance});
      for (int k = 0; k <= kTimes; ++k) {
        if (swept.hit && (k == kTimes || swept.time == 0)) break;
        const double t = swept.time * k / kTimes;
        ASSERT_FALSE(collide(pair.a, pose_a, pair.b, spline_pose_at(motion, t)).hit())
            << "at " << t << " before " << swept.time;
      }
      hits += swept.hit && swept.time > 0;
      frees += !swept.hit;
      if (!swept.hit) continue;
      const Pose at = spline_pose_at(motion, swept.time);
      ASSERT_LE(brute_pair_distance(pair.a.mesh(), pose_a, pair.b.mesh(), at), kTolerance * (1 + 1e-9));
      const Corners p = corners_at(pair.a.mesh(), swept.triangle_a, pose_a),
                    q = corners_at(pair.b.mesh(), swept.triangle_b, at);
      ASSERT_TRUE(triangles_intersect(p, q) ||
                  closest_points(p, q).distance_sq <= kTolerance * kTolerance * (1 + 1e-9));
    }
    EXPECT_GT(hits, 5);
    EXPECT_GT(frees, 3);
  }
}

// The chord of an arc runs high above a floor that the arc touches, and the chord of half an arc goes through a floor
// that the arc stays above.
TEST(SweepSpline, AnArcOverAFloor) {
  const Body floor(one_triangle({-9, -9, 0}, {9, -9, 0}, {0, 9, 0})),
      needle(one_triangle({0, 0, 0}, {0.01, 0, 0.2}, {0, 0.01, 0.2}));
  constexpr double kTolerance = 1e-5;
  for (const double lowest : {2e-5, 1e-3, 0.1}) {
    SCOPED_TRACE(lowest);
    const SweepResult swept = sweep_spline(floor, {}, needle, arc(lowest), {kTolerance});
    EXPECT_FALSE(swept.hit) << "at " << swept.time;
    EXPECT_EQ(swept.time, 1);
  }
  for (const double lowest : {-1e-4, -0.01, -0.5})
    for (const bool floor_moves : {false, true}) {
      SCOPED_TRACE(lowest);
      SplineMotion motion = arc(lowest);
      if (floor_moves) {
        motion.start.translation = motion.start.translation * -1.0;
        for (Vec3& point : motion.control) point = point * -1.0;
      }
      const SweepResult swept = floor_moves ? sweep_spline(needle, {}, floor, motion, {kTolerance})
                                            : sweep_spline(floor, {}, needle, motion, {kTolerance});
      ASSERT_TRUE(swept.hit);
      const auto time_at = [&](double height) { return (1 - std::sqrt(height - lowest)) / 2; };
      EXPECT_LE(swept.time, time_at(0) + 1e-12);
      EXPECT_GE(swept.time, time_at(kTolerance) - 1e-12);
      EXPECT_NEAR(std::abs(swept.normal.z), 1, 1e-6);
    }
}

// Control points at thirds of a straight line: the center moves with constant velocity.
TEST(SweepSpline, AStraightCurveIsAMotion) {
  const Body soup(random_soup(3, 40, 1, 0.5)), small(random_soup(4, 15, 0.3, 0.4));
  constexpr double kTolerance = 1e-6;
  Random random(52);
  int hits = 0;
  for (int n = 0; n < 40; ++n) {
    const Pose start = random_pose(random, 2.5);
    const Vec3 axis = random.in_cube(1) + Vec3{1e-3, 0, 0};
    const RigidMotion motion =
        screw_motion(start, start.translation + random.in_cube(0.3), axis, random.between(-9, 9), -4);
    SplineMotion curve{motion.start, motion.center, {}, motion.axis, motion.angle_rad};
    const Vec3 from = apply(motion.start, motion.center), way = apply(motion.end, motion.center) - from;
    for (std::size_t k = 0; k < 3; ++k) curve.control[k] = from + way * (static_cast<double>(k + 1) / 3);
    for (const double t : {0.0, 0.3, 0.9}) {
      const Pose found = spline_pose_at(curve, t), expected = pose_at(motion, t);
      ASSERT_LT(length(found.translation - expected.translation), 1e-13);
      for (std::size_t k = 0; k < 9; ++k) ASSERT_NEAR(found.rotation[k], expected.rotation[k], 1e-13);
    }
    const SweepResult found = sweep_spline(soup, {}, small, curve, {kTolerance}),
                      expected = sweep(soup, {}, small, motion, {kTolerance});
    EXPECT_EQ(found.hit, expected.hit);
    EXPECT_NEAR(found.time, expected.time, 1e-4);
    hits += found.hit;
  }
  EXPECT_GT(hits, 5);
}

TEST(SweepSpline, WhereItStartsAndWhereItEndsEarly) {
  const Body ball(ball_mesh(1, 3)), small(ball_mesh(0.3, 2));
  SplineMotion motion{.start = moved({1.1, 0, 0}), .control = {Vec3{2, 0, 0}, Vec3{3, 0, 0}, Vec3{4, 0, 0}}};
  const SweepResult inside = sweep_spline(ball, {}, small, motion);
  EXPECT_TRUE(inside.hit);
  EXPECT_EQ(inside.time, 0);
  EXPECT_EQ(inside.normal, Vec3{});
  // It starts nearer than the tolerance, and moves away.
  motion.start = moved({1.5, 0, 0});
  EXPECT_TRUE(sweep_spline(ball, {}, small, motion, {0.5}).hit);
  EXPECT_FALSE(sweep_spline(ball, {}, small, motion, {1e-3}).hit);
  // It turns just beside the ball.
  motion = {
      .start = moved({3, 0, 0}), .control = {Vec3{-1, 3, 0}, Vec3{-1, -3, 0}, Vec3{3, 0.5, 0}}, .axis = {0, 0, 1}};
  motion.angle_rad = 5;
  const SweepResult whole = sweep_spline(ball, {}, small, motion);
  ASSERT_TRUE(whole.hit);
  double before = 0;
  std::int64_t most = 1;
  for (;; ++most) {
    const SweepResult found = sweep_spline(ball, {}, small, motion, {.max_steps = most});
    EXPECT_GE(found.time, before);
    EXPECT_LE(found.time, whole.time);
    EXPECT_EQ(found.hit, found.finished);
    before = found.time;
    if (found.finished) break;
  }
  EXPECT_EQ(before, whole.time);
  EXPECT_GT(most, 10);
}

TEST(SweepSpline, ErrorsSayWhatIsWrong) {
  const Body body(one_triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}));
  const double nan = std::nan("");
  const auto expect_usage = [&](const std::string& words, const SplineMotion& motion) {
    for (const bool sweeps : {false, true}) try {
        if (sweeps)
          sweep_spline(body, {}, body, motion);
        else
          spline_pose_at(motion, 0.5);
        FAIL() << "no error: " << words;
      } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::usage);
        EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
      }
  };
  expect_usage("control point", {.control = {Vec3{}, Vec3{nan, 0, 0}, Vec3{}}});
  expect_usage("control point", {.control = {Vec3{}, Vec3{}, Vec3{0, 1e300, 0}}});
  expect_usage("center", {.center = {nan, 0, 0}});
  expect_usage("no axis", {.angle_rad = 1});
  expect_usage("radians", {.axis = {0, 0, 1}, .angle_rad = 1e8});
  expect_usage("not finite", {.axis = {0, 0, nan}, .angle_rad = 1});
  expect_usage("rotation", {.start = {{2, 0, 0, 0, 2, 0, 0, 0, 2}, {}}});
  EXPECT_THROW(spline_pose_at({}, 1.5), Error);
}

}  // namespace
}  // namespace standoff
