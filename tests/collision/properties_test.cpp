// SPDX-License-Identifier: Apache-2.0
// Properties that hold for all bodies.
#include <gtest/gtest.h>

#include <set>

#include "standoff/collision.h"
#include "tests/collision/bodies.h"

namespace standoff {
namespace {

using namespace standoff::testing;

TEST(Properties, ALargerMarginKeepsHits) {
  const Body a(random_soup(1, 100, 1, 0.3)), b(ball_mesh(0.4, 3));
  Random random(2);
  for (int n = 0; n < 200; ++n) {
    const Pose pose = random_pose(random, 3);
    const double d = distance(a, {}, b, pose).upper;
    bool before = false;
    for (const double margin : {0.0, 0.1, 0.5, 1.0, 2.0}) {
      const bool hit = collide(a, {}, b, pose, {.margin = margin}).hit();
      ASSERT_TRUE(hit || !before);
      ASSERT_EQ(hit, d <= margin);
      const Verdict certified = collide(a, {}, b, pose, {.margin = margin, .mode = CollideMode::certified}).verdict;
      ASSERT_TRUE(certified == Verdict::ambiguous || (certified == Verdict::hit) == hit);
      before = hit;
    }
  }
}

TEST(Properties, AnswersDoNotDependOnWhereTheWorldIs) {
  const Body a(random_soup(1, 100, 1, 0.3)), b(ball_mesh(0.4, 3));
  Random random(3);
  for (int n = 0; n < 100; ++n) {
    const Pose pose = random_pose(random, 2), world = random_pose(random, 100);
    const double d = distance(a, {}, b, pose).upper;
    EXPECT_NEAR(distance(a, world, b, compose(world, pose)).upper, d, 1e-12 * 100);
    EXPECT_FALSE(d > 1e-9 && collide(a, world, b, compose(world, pose)).hit());
  }
}

TEST(Properties, LargerBodiesMeetEarlier) {
  const Body a(ball_mesh(1, 4));
  Random random(4);
  const Mesh small = ball_mesh(0.2, 3), large = ball_mesh(0.3, 3);
  const Body b(small), c(large);
  for (int n = 0; n < 200; ++n) {
    RigidMotion motion{random_pose(random, 3), {}, {}};
    motion.end = motion.start;
    motion.end.translation = random.in_cube(3);
    const SweepResult of_small = sweep(a, {}, b, motion), of_large = sweep(a, {}, c, motion);
    const double length_of_way = length(motion.end.translation - motion.start.translation);
    // The larger ball holds the smaller one, up to its flat faces and the tolerance.
    EXPECT_TRUE(of_large.hit || !of_small.hit);
    EXPECT_LE(of_large.time * length_of_way, of_small.time * length_of_way + 2e-4);
  }
}

// The order of the bodies does not matter.
TEST(Properties, BothOrdersGiveTheSameAnswers) {
  const Body a(random_soup(1, 150, 1, 0.3)), b(ball_mesh(0.5, 4));
  Random random(6);
  for (int n = 0; n < 150; ++n) {
    SCOPED_TRACE("pose " + std::to_string(n));
    const Pose pose_a = random_pose(random, 1), pose_b = random_pose(random, 1);
    const double margin = n % 3 * 0.1;
    EXPECT_EQ(collide(a, pose_a, b, pose_b, {.margin = margin}).hit(),
              collide(b, pose_b, a, pose_a, {.margin = margin}).hit());
    const DistanceResult one = distance(a, pose_a, b, pose_b), other = distance(b, pose_b, a, pose_a);
    EXPECT_NEAR(one.upper, other.upper, 1e-13);
    const ContactOptions all{.most = 1'000'000, .margin = margin};
    const ContactResult at = contacts(a, pose_a, b, pose_b, all), turned = contacts(b, pose_b, a, pose_a, all);
    ASSERT_EQ(at.contacts.size(), turned.contacts.size());
    using Row = std::tuple<std::uint32_t, std::uint32_t, double>;
    std::set<Row> rows, turned_rows;
    for (const ContactPoint& c : at.contacts) rows.insert({c.triangle_a, c.triangle_b, std::round(c.depth * 1e9)});
    for (const ContactPoint& c : turned.contacts)
      turned_rows.insert({c.triangle_b, c.triangle_a, std::round(c.depth * 1e9)});
    EXPECT_EQ(rows, turned_rows);
  }
}

// It does not matter which body moves: a translation of b equals the opposite translation of a.
TEST(Properties, SweepsOfTheOtherBodyEndAtTheSameTime) {
  const Body a(random_soup(1, 60, 1, 0.3)), b(ball_mesh(0.3, 3));
  constexpr double kTolerance = 1e-6;
  Random random(7);
  int hits = 0;
  for (int n = 0; n < 200; ++n) {
    const Pose rest = random_pose(random, 1), from = random_pose(random, 3);
    if (collide(a, rest, b, from, {.margin = 10 * kTolerance}).hit()) continue;
    const Vec3 translation = random.in_cube(5);
    Pose to = from, back = rest;
    to.translation = to.translation + translation, back.translation = back.translation - translation;
    const SweepResult one = sweep(a, rest, b, {from, to, {}}, {kTolerance}),
                      other = sweep(b, from, a, {rest, back, {}}, {kTolerance});
    // A hit is a time within the tolerance; on grazing motions, touching comes much later.
    if (one.hit != other.hit || std::abs(one.time - other.time) * length(translation) > 2 * kTolerance) {
      const double t = std::min(one.time, other.time);
      Pose at = from;
      at.translation = at.translation + translation * t;
      EXPECT_LE(distance(a, rest, b, at).upper, kTolerance * (1 + 1e-6)) << "pose " << n;
    }
    hits += one.hit;
  }
  EXPECT_GT(hits, 10);
}

TEST(Properties, SweepsDoNotDependOnWhereTheWorldIs) {
  const Body a(random_soup(1, 60, 1, 0.3)), b(ball_mesh(0.3, 3));
  constexpr double kTolerance = 1e-6;
  Random random(8);
  for (int n = 0; n < 150; ++n) {
    const Pose world = random_pose(random, 50);
    RigidMotion motion{random_pose(random, 3), random_pose(random, 3), random.in_cube(0.3)}, moved_motion = motion;
    if (collide(a, {}, b, motion.start, {.margin = 10 * kTolerance}).hit()) continue;
    moved_motion.start = compose(world, motion.start), moved_motion.end = compose(world, motion.end);
    const SweepResult here = sweep(a, {}, b, motion, {kTolerance}),
                      there = sweep(a, world, b, moved_motion, {kTolerance});
    if (here.hit == there.hit && std::abs(here.time - there.time) < 1e-6) continue;
    const double t = std::min(here.time, there.time);
    EXPECT_LE(distance(a, {}, b, pose_at(motion, t)).upper, kTolerance * (1 + 1e-6)) << "pose " << n;
  }
}

TEST(Properties, AWiderToleranceEndsASweepNoLater) {
  const Body a(random_soup(1, 60, 1, 0.3)), b(ball_mesh(0.3, 3));
  Random random(9);
  for (int n = 0; n < 150; ++n) {
    const RigidMotion motion{random_pose(random, 3), random_pose(random, 3), {}};
    if (collide(a, {}, b, motion.start, {.margin = 0.5}).hit()) continue;
    double before = 2;
    for (const double tolerance : {1e-6, 1e-4, 1e-2, 0.3}) {
      const SweepResult swept = sweep(a, {}, b, motion, {tolerance});
      const double time = swept.hit ? swept.time : 2;
      // A hit is the first time within the tolerance, or up to half of it nearer.
      EXPECT_LE(time, before + 1e-12) << "pose " << n << ", tolerance " << tolerance;
      before = time;
    }
  }
}

TEST(Properties, AWiderMarginKeepsContacts) {
  const Body a(random_soup(1, 60, 1, 0.4)), b(ball_mesh(0.4, 2));
  Random random(10);
  for (int n = 0; n < 60; ++n) {
    const Pose pose = random_pose(random, 1.5);
    std::set<std::pair<std::uint32_t, std::uint32_t>> before;
    for (const double margin : {0.0, 0.05, 0.5, 5.0}) {
      std::set<std::pair<std::uint32_t, std::uint32_t>> pairs;
      for (const ContactPoint& c : contacts(a, {}, b, pose, {.most = 1'000'000, .margin = margin}).contacts)
        pairs.insert({c.triangle_a, c.triangle_b});
      EXPECT_TRUE(std::includes(pairs.begin(), pairs.end(), before.begin(), before.end())) << "pose " << n;
      before = pairs;
    }
    EXPECT_EQ(before.size(), 60u * 32u) << "all pairs are within 5";
  }
}

}  // namespace
}  // namespace standoff
