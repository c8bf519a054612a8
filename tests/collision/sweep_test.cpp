// SPDX-License-Identifier: Apache-2.0
// Compares sweeps with every pair of triangles at many times of the motion.
#include <gtest/gtest.h>

#include "standoff/collision.h"
#include "tests/collision/bodies.h"

namespace standoff {
namespace {

using namespace standoff::testing;

struct SweepCase {
  Pose pose_a;
  RigidMotion motion;
};

SweepCase random_case(Random& random, double half, double translation, double turn, bool at_rest_at_origin) {
  SweepCase c;
  if (!at_rest_at_origin) c.pose_a = random_pose(random, half);
  c.motion.start = random_pose(random, half);
  c.motion.center = random.in_cube(0.5);
  const Pose delta = make_pose(random.in_cube(1) + Vec3{1e-3, 0, 0}, random.between(0, turn), {});
  c.motion.end.rotation = compose(delta, c.motion.start).rotation;
  c.motion.end.translation = c.motion.start.translation + random.in_cube(translation);
  return c;
}

void expect_sound(const Mesh& a, const Mesh& b, int cases, double half, double translation, double turn,
                  unsigned seed) {
  const Body model_a(a), model_b(b);
  Random random(seed);
  constexpr double kTolerance = 1e-3;
  int hits = 0, frees = 0;
  for (int n = 0; n < cases; ++n) {
    SCOPED_TRACE("case " + std::to_string(n));
    const SweepCase c = random_case(random, half, translation, turn, n % 2);
    const SweepResult swept = sweep(model_a, c.pose_a, model_b, c.motion, {.tolerance = kTolerance});
    constexpr int kTimes = 40;
    for (int k = 0; k <= kTimes; ++k) {
      const double t = swept.time * k / kTimes;
      if (swept.hit && (k == kTimes || swept.time == 0)) break;
      ASSERT_FALSE(brute_touch(a, c.pose_a, b, pose_at(c.motion, t))) << "at " << t << " before " << swept.time;
    }
    hits += swept.hit && swept.time > 0;
    frees += !swept.hit;
    if (!swept.hit) continue;
    const double apart = brute_pair_distance(a, c.pose_a, b, pose_at(c.motion, swept.time));
    ASSERT_LE(apart, kTolerance * (1 + 1e-9));
    const Corners p = corners_at(a, swept.triangle_a, c.pose_a),
                  q = corners_at(b, swept.triangle_b, pose_at(c.motion, swept.time));
    ASSERT_TRUE(triangles_intersect(p, q) || closest_points(p, q).distance_sq <= kTolerance * kTolerance * (1 + 1e-9));
  }
  EXPECT_GT(hits, cases / 20);
  EXPECT_GT(frees, cases / 20);
}

TEST(Sweep, Straight) {
  expect_sound(ball_mesh(1, 4), ball_mesh(0.4, 2), 200, 2, 4, 0, 1);
  expect_sound(random_soup(3, 40, 1, 0.5), random_soup(4, 15, 0.3, 0.3), 200, 2, 4, 0, 2);
}

TEST(Sweep, Turning) {
  expect_sound(ball_mesh(1, 3), random_soup(5, 15, 0.3, 0.5), 200, 2, 3, 3.1, 3);
  expect_sound(random_soup(3, 40, 1, 0.5), random_soup(4, 15, 0.3, 0.3), 200, 2, 3, 1, 4);
}

TEST(Sweep, TheLargerBodyMoves) {
  expect_sound(random_soup(4, 15, 0.3, 0.3), random_soup(3, 40, 1, 0.5), 200, 2, 3, 3, 5);
  expect_sound(ball_mesh(0.4, 2), ball_mesh(1, 3), 100, 2, 4, 0, 6);
}

// A straight motion does not depend on the point that it is given for. The rounding of a far point once carried the
// body through a wall.
TEST(Sweep, AStraightMotionDoesNotDependOnTheCenter) {
  Mesh wall;
  add_triangle(wall, {0, -9, -9}, {0, 9, -9}, {0, 0, 9});
  const Body resting(wall), box(ball_mesh(0.5, 2));
  RigidMotion motion;
  motion.start.translation = {-10, 0, 0}, motion.end.translation = {10, 0, 0};
  const SweepResult near = sweep(resting, {}, box, motion);
  ASSERT_TRUE(near.hit);
  motion.center = {1e15, -1e15, 3};
  const SweepResult far = sweep(resting, {}, box, motion);
  EXPECT_TRUE(far.hit);
  EXPECT_EQ(far.time, near.time);
  motion.center.x = 2e15;
  EXPECT_THROW(sweep(resting, {}, box, motion), Error);
}

// The blade rotates about the centre of its bounding sphere, so the sphere rests while the blade moves. If the box of
// its first step was free, such a triangle once counted as free for ever, and passed through the post.
TEST(Sweep, ATriangleTurnsAboutTheCentreOfItsSphere) {
  const Mesh blade = one_triangle({-1, -0.1, 0}, {1, -0.1, 0}, {0, 0.1, 0});
  Mesh posts = one_triangle({-0.05, 0.6, -0.1}, {0.05, 0.6, -0.1}, {0, 0.62, 0.1});
  add_triangle(posts, {3, 3, 3}, {3.1, 3, 3}, {3, 3.1, 3});  // makes them the larger body
  const Body turning(blade), resting(posts);
  RigidMotion motion;
  for (const double angle_rad : {3.0, -3.0}) {
    motion.end = make_pose({0, 0, 1}, angle_rad, {});
    const SweepResult blade_turns = sweep(resting, {}, turning, motion),
                      posts_turn = sweep(turning, {}, resting, motion);
    for (const SweepResult& swept : {blade_turns, posts_turn}) {
      ASSERT_TRUE(swept.hit);
      EXPECT_NEAR(swept.time, 0.5, 0.1);
    }
    EXPECT_LT(brute_pair_distance(posts, {}, blade, pose_at(motion, blade_turns.time)), 1e-4);
    EXPECT_LT(brute_pair_distance(blade, {}, posts, pose_at(motion, posts_turn.time)), 1e-4);
  }
}

// The default was once 1e-4 world units: bodies 1e-6 across hit bodies that they passed at a hundred times their size,
// and bodies 1e6 across advanced to within 1e-10 of their size.
TEST(Sweep, TheDefaultToleranceHasTheScaleOfTheBodies) {
  for (const double size : {1e-9, 1e-6, 1.0, 1e6, 1e9}) {
    SCOPED_TRACE(size);
    Mesh wall;
    add_triangle(wall, {0, -9 * size, -9 * size}, {0, 9 * size, -9 * size}, {0, 0, 9 * size});
    const Body resting(wall), box(ball_mesh(0.5 * size, 2));
    const double tolerance = automatic_tolerance(resting, box);
    EXPECT_GE(tolerance, 0x1p-16 * size);
    EXPECT_LE(tolerance, 0x1p-14 * size);
    EXPECT_EQ(tolerance, automatic_tolerance(box, resting));
    RigidMotion motion;
    motion.start.translation = {-10 * size, 0, 0}, motion.end.translation = {10 * size, 0, 0};
    const SweepResult by_default = sweep(resting, {}, box, motion);
    ASSERT_TRUE(by_default.hit);
    EXPECT_EQ(by_default.time, sweep(resting, {}, box, motion, {tolerance}).time);
    EXPECT_NEAR(by_default.time, 0.475, 0.03);
    // Pass the wall at a distance of the body's own size.
    motion.start.translation = motion.end.translation = {1.5 * size, 0, 0};
    motion.end.translation.y = size;
    EXPECT_FALSE(sweep(resting, {}, box, motion).hit);
  }
  const Body point(one_triangle({1, 1, 1}, {1, 1, 1}, {1, 1, 1})), ball(ball_mesh(8, 2));
  EXPECT_GT(automatic_tolerance(point, point), 0);
  EXPECT_GE(automatic_tolerance(point, ball), 0x1p-36);
  EXPECT_LE(automatic_tolerance(point, ball), 0x1p-35);
}

// A mesh 2e10 from its own origin: the translations of its poses are rounded by 4e-6. A needle passes an edge at a
// smaller distance. The exact path does not touch it, but rounded poses on the path do.
TEST(Sweep, WhatRoundsThePosesIsKeptBetweenBodies) {
  const Vec3 far{-301108018.0963652, -18188532272.843033, 11690617903.502226}, x{1, 0, 0};
  const Body still(one_triangle({0, -1, -1}, {0, 1, 1}, {0, 1, -1})), needle(one_triangle(far - x, far + x, far + x));
  int free = 0;
  for (int n = 0; n < 200; ++n) {
    const double beside = 1e-7 * std::pow(1.08, n);
    const Vec3 from = Vec3{0, -2e-4 - beside, -2e-4 + beside} - far, translation{0, 4e-4, 4e-4};
    const RigidMotion motion{moved(from), moved(from + translation), {}};
    const SweepResult swept = sweep(still, {}, needle, motion, {1e-7});
    free += !swept.hit;
    for (int k = 0; k < 100 && swept.time > 0; ++k)
      ASSERT_FALSE(collide(still, {}, needle, pose_at(motion, swept.time * k / 100)).hit()) << n << ", " << k;
  }
  EXPECT_GT(free, 20);
}

// The tip of a hand that rotates about z starts along a wall and curves into it: at first it does not approach it.
TEST(Sweep, AHandThatStartsAlongAWallMeetsIt) {
  Mesh wall;
  add_triangle(wall, {0.9, -9, -5}, {0.9, 9, -5}, {0.9, 0, 9});
  const Body resting(wall), tip(one_triangle({1, 0, 0}, {1.1, 0, 0.05}, {1.1, 0, -0.05}));
  constexpr double kTolerance = 1e-6;
  for (const double turn : {0.5, 1.5, 3.1})
    for (const bool wall_turns : {false, true}) {
      SCOPED_TRACE(turn);
      const RigidMotion motion{{}, make_pose({0, 0, 1}, turn, {}), {}};
      const SweepResult swept =
          wall_turns ? sweep(tip, {}, resting, motion, {kTolerance}) : sweep(resting, {}, tip, motion, {kTolerance});
      ASSERT_TRUE(swept.hit);
      EXPECT_LE(swept.time * turn, std::acos(0.9) + 1e-12);
      EXPECT_GE(swept.time * turn, std::acos(0.9 + kTolerance) - 1e-9);
    }
}

// A hexagonal shaft rotates in a hexagonal sleeve. Its edges, 1 from the axis, meet the sleeve's sides, `apothem` from
// the axis, when the cosine of the angle to a side's normal is the apothem. Nearly all of the rotation slides along.
TEST(Sweep, AShaftTurnsInItsSleeve) {
  const auto tube = [](double radius) {
    Mesh mesh;
    const auto at = [&](int side, int ring) {
      const double angle = side * std::numbers::pi / 3;
      return Vec3{radius * std::cos(angle), radius * std::sin(angle), ring * 0.5};
    };
    for (int side = 0; side < 6; ++side)
      for (int ring = 0; ring < 4; ++ring) {
        add_triangle(mesh, at(side, ring), at(side + 1, ring), at(side, ring + 1));
        add_triangle(mesh, at(side + 1, ring), at(side + 1, ring + 1), at(side, ring + 1));
      }
    return mesh;
  };
  const Body shaft(tube(1));
  constexpr double kTolerance = 1e-5, kTurn = 3;
  const double sixth = std::numbers::pi / 6;
  for (const double apothem : {0.9, 0.99, 0.9999, 1.0001, 1.1}) {
    SCOPED_TRACE(apothem);
    const Body sleeve(tube(apothem / std::cos(sixth)));
    for (const Vec3 axis : {Vec3{0, 0, 1}, Vec3{0, 0, -1}})
      for (const bool sleeve_turns : {false, true}) {
        Random random(1);
        const Pose world = random_pose(random, 3);
        const RigidMotion motion{world, compose(world, make_pose(axis, kTurn, {})), {0, 0, 0.3}};
        const SweepResult swept = sleeve_turns ? sweep(shaft, world, sleeve, motion, {kTolerance})
                                               : sweep(sleeve, world, shaft, motion, {kTolerance});
        ASSERT_EQ(swept.hit, apothem < 1 + kTolerance);
        if (!swept.hit) continue;
        EXPECT_LE(swept.time * kTurn, sixth - std::acos(apothem) + 1e-12);
        EXPECT_GE(swept.time * kTurn, sixth - std::acos(apothem - kTolerance) - 1e-9);
      }
  }
}

}  // namespace
}  // namespace standoff
