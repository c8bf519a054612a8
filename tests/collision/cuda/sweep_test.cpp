// SPDX-License-Identifier: Apache-2.0
// Sweeps for many motions by the emulated GPU's kernels: motions that they call free are free for the CPU too, and all
// answers equal the CPU's.
#include <gtest/gtest.h>

#include <string>

#include "collision/sweep.h"
#include "gpu/emulation/block.h"
#include "scenes/scenes.h"
#include "standoff/collision.h"
#include "standoff/cuda.h"
#include "standoff/testing/emulation.h"
#include "tests/collision/bodies.h"

namespace standoff {
namespace {

using namespace standoff::testing;
using emulation::Order;
using emulation::OrderScope;

const Execution kOnEmulation{.threads = 2, .backend = testing::kEmulated};

RigidMotion random_motion(Random& random, double half, double translation, double turn, Vec3 around = {}) {
  RigidMotion motion;
  motion.start = random_pose(random, half);
  motion.start.translation = motion.start.translation + around;
  motion.center = random.in_cube(0.5);
  const Pose delta = make_pose(random.in_cube(1) + Vec3{1e-3, 0, 0}, random.between(0, turn), {});
  motion.end.rotation = turn > 0 ? compose(delta, motion.start).rotation : motion.start.rotation;
  motion.end.translation = motion.start.translation + random.in_cube(translation);
  return motion;
}

std::vector<RigidMotion> random_motions(unsigned seed, int count, double half, double translation, double turn,
                                        Vec3 around = {}) {
  Random random(seed);
  std::vector<RigidMotion> motions;
  for (int n = 0; n < count; ++n) motions.push_back(random_motion(random, half, translation, turn, around));
  return motions;
}

struct SweepCounts {
  int hits = 0;
  BatchReport report;
};

SweepCounts expect_as_cpu(const Body& a, const Pose& pose_a, const Body& b, const std::vector<RigidMotion>& motions,
                          double tolerance, int stack = collision::kDeviceStack) {
  const auto expected = sweep_all(a, pose_a, b, motions, {.tolerance = tolerance}, {.backend = Backend::cpu}).results;
  SweepCounts counts;
  const auto found = collision::sweep_on_device(*collision::find_device(testing::kEmulated, 1), a, pose_a, b, motions,
                                                {.tolerance = tolerance}, kOnEmulation, counts.report, stack);
  EXPECT_EQ(found.size(), motions.size());
  for (std::size_t n = 0; n < motions.size(); ++n) {
    SCOPED_TRACE("motion " + std::to_string(n));
    EXPECT_EQ(found[n].hit, expected[n].hit);
    EXPECT_EQ(found[n].time, expected[n].time);
    EXPECT_EQ(found[n].triangle_a, expected[n].triangle_a);
    EXPECT_EQ(found[n].triangle_b, expected[n].triangle_b);
    counts.hits += expected[n].hit;
  }
  EXPECT_EQ(counts.report.on_device + counts.report.undecided + counts.report.overflowed,
            static_cast<std::int64_t>(motions.size()));
  return counts;
}

void expect_both(const SweepCounts& counts, int motions) {
  EXPECT_GT(counts.hits, motions / 20);
  EXPECT_LT(counts.hits, motions * 19 / 20);
  EXPECT_GT(counts.report.on_device, (motions - counts.hits) * 8 / 10) << counts.hits << " hits";
  EXPECT_EQ(counts.report.overflowed, 0);
}

TEST(CudaSweep, MissesNothing) {
  const Body ball(ball_mesh(1, 12)), soup(random_soup(3, 40, 1, 0.5)), small(random_soup(5, 30, 0.3, 0.4));
  for (const Order order : {Order::forward, Order::reverse, Order::random}) {
    SCOPED_TRACE("order " + std::to_string(static_cast<int>(order)));
    const OrderScope scope(order, 11);
    expect_both(expect_as_cpu(ball, {}, small, random_motions(1, 300, 2.5, 4, 0), 1e-4), 300);
    expect_both(expect_as_cpu(soup, {}, small, random_motions(2, 300, 2.5, 3, 3.1), 1e-3), 300);
  }
}

TEST(CudaSweep, EitherTheLargerAndBothPlaced) {
  const Body large(ball_mesh(1, 7)), small(random_soup(6, 40, 0.4, 0.4));
  Random random(7);
  for (int n = 0; n < 2; ++n) {
    const Pose pose = random_pose(random, 5);
    const auto motions = random_motions(8 + n, 100, 2.5, 3, 3, pose.translation);
    expect_both(expect_as_cpu(large, pose, small, motions, 1e-3), 100);
    expect_both(expect_as_cpu(small, pose, large, motions, 1e-3), 100);
  }
}

TEST(CudaSweep, WhatPassesWithinTheToleranceIsNotFree) {
  const Body large(ball_mesh(1, 7)), small(random_soup(16, 20, 0.1, 0.1));
  const SweepCounts counts = expect_as_cpu(large, {}, small, random_motions(17, 300, 2.5, 4, 1), 0.25);
  expect_both(counts, 300);
}

TEST(CudaSweep, FarFromTheOriginAndInOtherUnits) {
  for (const double unit : {1e-9, 1e9}) {
    SCOPED_TRACE(unit);
    const Vec3 far = Vec3{3e3, -2e4, 77} * unit;
    const Body large(ball_mesh(unit, 5, far)), small(random_soup(22, 30, 0.3 * unit, 0.4 * unit));
    std::vector<RigidMotion> motions = random_motions(23, 120, 2.5, 3, 2);
    for (RigidMotion& motion : motions) {
      motion.center = motion.center * unit;
      for (Pose* pose : {&motion.start, &motion.end}) pose->translation = pose->translation * unit + far;
    }
    expect_both(expect_as_cpu(large, {}, small, motions, 1e-3 * unit), 120);
    expect_as_cpu(small, {}, large, motions, 1e-3 * unit);
  }
}

// Coarse fields let triangles look far ahead, where their paths are arcs: a stake that stands where the arc is farthest
// from its chord.
TEST(CudaSweep, TurningOnTheSpot) {
  const Body stake(one_triangle({1, 0, -0.5}, {1.01, 0, 0.5}, {1.01, 0.01, 0.5}), {.spacing = 1}),
      fin(one_triangle({1, 0, -0.3}, {1.01, 0, 0.3}, {1.02, 0.01, 0.3}));
  std::vector<RigidMotion> motions;
  for (double angle = -1.2; angle < 0.3; angle += 0.02)
    motions.push_back({make_pose({0, 0, 1}, angle, {}), make_pose({0, 0, 1}, angle + 3, {}), {}});
  const SweepCounts counts = expect_as_cpu(stake, {}, fin, motions, 1e-4);
  EXPECT_GT(counts.hits, 50);
  EXPECT_GT(counts.report.on_device, 5);
  EXPECT_GT(expect_as_cpu(fin, {}, stake, motions, 1e-4).hits, 50);  // now the body with the field turns
}

// Up to four turns, whichever of the bodies has the field.
TEST(CudaSweep, ManyTurns) {
  const Body ball(ball_mesh(1, 7)), soup(random_soup(24, 30, 0.3, 0.4));
  Random random(25);
  std::vector<RigidMotion> motions;
  for (int n = 0; n < 150; ++n) {
    const Pose start = random_pose(random, 2.5);
    const Vec3 axis = random.in_cube(1) + Vec3{1e-3, 0, 0};
    motions.push_back(screw_motion(start, start.translation + random.in_cube(0.5), axis, random.between(-25, 25),
                                   random.between(-3, 3)));
  }
  expect_both(expect_as_cpu(ball, {}, soup, motions, 1e-3), 150);
  expect_both(expect_as_cpu(soup, {}, ball, motions, 1e-3), 150);
}

TEST(CudaSweep, FastAndSlowAndNotAtAll) {
  const Body large(ball_mesh(1, 7)), small(ball_mesh(0.3, 3));
  for (const double translation : {0.02, 40.0}) {
    SCOPED_TRACE("translation " + std::to_string(translation));
    const SweepCounts counts = expect_as_cpu(large, {}, small, random_motions(10, 200, 2, translation, 0.5), 1e-4);
    EXPECT_GT(counts.report.on_device, 50);
    EXPECT_GT(counts.hits, 5);
  }
  std::vector<RigidMotion> still = random_motions(11, 60, 1.5, 1, 1);
  for (RigidMotion& motion : still) motion.end = motion.start;
  EXPECT_GT(expect_as_cpu(large, {}, small, still, 1e-4).hits, 5);
}

TEST(CudaSweep, Scenes) {
  const Body maze(scenes::make("labyrinth", 2000)), fly(scenes::make("fly", 300));
  const Box box = maze.bounds();
  Random random(12);
  std::vector<RigidMotion> motions;
  for (int n = 0; n < 100; ++n) {
    const Vec3 at = box.center() +
                    Vec3{random.between(-0.5, 0.5), random.between(-0.5, 0.5), random.between(0, 0.7)} * box.extent();
    motions.push_back(random_motion(random, 0, 5, 1, at));
  }
  EXPECT_GT(expect_as_cpu(maze, {}, fly, motions, 1e-4).hits, 20);
}

TEST(CudaSweep, WhereTheStackIsFullTheCpuAnswers) {
  const Body ball(ball_mesh(1, 12)), soup(random_soup(13, 600, 0.5, 0.2));
  std::int64_t before = 0;
  for (const int stack : {20, 2}) {
    const SweepCounts counts = expect_as_cpu(ball, {}, soup, random_motions(14, 80, 2, 3, 1), 1e-3, stack);
    EXPECT_GE(counts.report.overflowed, before);
    before = counts.report.overflowed;
  }
  EXPECT_GT(before, 20);
  // The BVH of a single triangle never waits on the stack: the boxes of the other body overflow.
  const Body one(one_triangle({0, 0, 0}, {0.3, 0, 0}, {0, 0.3, 0}));
  EXPECT_GT(expect_as_cpu(soup, {}, one, random_motions(18, 80, 1, 1, 1), 1e-3, 2).report.overflowed, 20);
}

TEST(CudaSweep, ThePublicCallSaysWhatItDid) {
  const Body a(ball_mesh(1, 4)), b(ball_mesh(0.5, 3));
  const auto motions = random_motions(15, 40, 2.5, 3, 1);
  const auto [found, report] = sweep_all(a, {}, b, motions, {}, kOnEmulation);
  const auto expected = sweep_all(a, {}, b, motions, {}, {.threads = 1}).results;
  for (std::size_t n = 0; n < motions.size(); ++n) EXPECT_EQ(found[n].hit, expected[n].hit);
  EXPECT_EQ(report.backend, "emulated");
  EXPECT_GT(report.on_device, 0);
  EXPECT_GT(report.undecided, 0);
  if (!cuda::devices().empty()) return;
  try {
    static_cast<void>(sweep_all(a, {}, b, motions, {}, {.backend = Backend::cuda}).results);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::device);
  }
}

}  // namespace
}  // namespace standoff
