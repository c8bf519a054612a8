// SPDX-License-Identifier: Apache-2.0
// Bodies far away, tiny, huge, thin, and rotated by matrices rounded to single precision: compares answers with every
// pair of triangles in the world.
#include <gtest/gtest.h>

#include "standoff/collision.h"
#include "tests/collision/bodies.h"

namespace standoff {
namespace {

using namespace standoff::testing;

Mesh scaled(Mesh mesh, Vec3 by, Vec3 to = {}) {
  for (Vec3& v : mesh.vertices) v = v * by + to;
  return mesh;
}

struct Tally {
  int hits = 0, frees = 0;
};

// Poses within `half` of `at`, some of them so that the bodies just meet.
Tally expect_as_brute_force(const Mesh& a, const Mesh& b, int poses, double half, Vec3 at, unsigned seed,
                            bool rounded = false) {
  const Body model_a(a), model_b(b);
  Random random(seed);
  Tally tally;
  const auto round = [&](Pose pose) {
    if (rounded)
      for (double& r : pose.rotation) r = static_cast<float>(r);
    pose.translation = pose.translation + at;
    return pose;
  };
  for (int n = 0; n < poses; ++n) {
    SCOPED_TRACE("pose " + std::to_string(n));
    const Pose pose_a = round(random_pose(random, half));
    Pose pose_b = round(random_pose(random, half));
    // Move half of them along the shortest separation until they touch, up to rounding.
    if (n % 2) {
      const DistanceResult apart = distance(model_a, pose_a, model_b, pose_b);
      pose_b.translation = pose_b.translation + (apart.point_a - apart.point_b);
    }
    const bool expected = brute_touch(a, pose_a, b, pose_b);
    (expected ? tally.hits : tally.frees)++;
    EXPECT_EQ(collide(model_a, pose_a, model_b, pose_b).hit(), expected);
    EXPECT_EQ(collide(model_b, pose_b, model_a, pose_a).hit(), expected);
    const Verdict certified = collide(model_a, pose_a, model_b, pose_b, {.mode = CollideMode::certified}).verdict;
    EXPECT_TRUE(certified == Verdict::ambiguous || !expected);
    const double nearest = brute_pair_distance(a, pose_a, b, pose_b);
    const double digits = 1e-12 * (length(at) + half);
    const DistanceResult found = distance(model_a, pose_a, model_b, pose_b);
    EXPECT_NEAR(found.upper, nearest, digits);
    EXPECT_TRUE(found.upper == 0 || !expected);  // a distance below rounding may be 0 too
    const double margin = 0.3 * half;
    if (std::abs(nearest - margin) > digits) {
      EXPECT_EQ(collide(model_a, pose_a, model_b, pose_b, {.margin = margin}).hit(), nearest <= margin);
    }
    const ContactResult some = contacts(model_a, pose_a, model_b, pose_b, {.most = 1});
    EXPECT_EQ(some.contacts.empty(), !expected);
  }
  return tally;
}

TEST(Scales, FarFromTheOrigin) {
  for (const double far : {1e6, 1e9, 1e12, 1e14}) {
    SCOPED_TRACE(far);
    const Tally tally =
        expect_as_brute_force(ball_mesh(1, 3), random_soup(3, 30, 0.7, 0.4), 60, 1.5, {far, -far / 3, far / 7}, 1);
    EXPECT_GT(tally.hits, 5);
    EXPECT_GT(tally.frees, 5);
  }
}

TEST(Scales, MeshesFarFromTheirOwnOrigin) {
  for (const double far : {1e6, 1e12}) {
    SCOPED_TRACE(far);
    const Vec3 at{far, far / 3, -far};
    const Mesh a = scaled(ball_mesh(1, 3), {1, 1, 1}, at), b = scaled(random_soup(3, 30, 0.7, 0.4), {1, 1, 1}, at);
    const Body model_a(a), model_b(b);
    Random random(2);
    int hits = 0;
    for (int n = 0; n < 100; ++n) {
      const Pose pose = moved(random.in_cube(3));
      const bool expected = brute_touch(a, {}, b, pose);
      EXPECT_EQ(collide(model_a, {}, model_b, pose).hit(), expected) << n;
      EXPECT_NEAR(distance(model_a, {}, model_b, pose).upper, brute_pair_distance(a, {}, b, pose), 1e-15 * far) << n;
      hits += expected;
    }
    EXPECT_GT(hits, 5);
    EXPECT_LT(hits, 95);
  }
}

TEST(Scales, TinyAndHuge) {
  for (const double scale : {1e-11, 1e-6, 1e6, 3e11}) {
    SCOPED_TRACE(scale);
    const Vec3 by{scale, scale, scale};
    const Tally tally = expect_as_brute_force(scaled(ball_mesh(1, 3), by), scaled(random_soup(3, 30, 0.7, 0.4), by), 60,
                                              1.5 * scale, {}, 3);
    EXPECT_GT(tally.hits, 5);
    EXPECT_GT(tally.frees, 5);
  }
}

TEST(Scales, ATinyBodyAtAHugeOne) {
  const Mesh huge = scaled(ball_mesh(1, 6), {1e6, 1e6, 1e6}), tiny = scaled(ball_mesh(1, 2), {1e-3, 1e-3, 1e-3});
  const Body of_huge(huge), of_tiny(tiny);
  Random random(4);
  int hits = 0;
  for (int n = 0; n < 100; ++n) {
    const Pose turned = random_pose(random, 1e3);
    // On the surface of the huge one, off by about the size of the tiny one.
    const std::size_t t = random.below(static_cast<std::uint32_t>(huge.triangles.size()));
    const MeshView view = huge;
    const Vec3 on = apply(turned, (view.corner(t, 0) + view.corner(t, 1) + view.corner(t, 2)) * (1 / 3.0));
    Pose pose = random_pose(random, 2e-3);
    pose.translation = pose.translation + on;
    const bool expected = brute_touch(huge, turned, tiny, pose);
    EXPECT_EQ(collide(of_huge, turned, of_tiny, pose).hit(), expected) << n;
    EXPECT_NEAR(distance(of_huge, turned, of_tiny, pose).upper, brute_pair_distance(huge, turned, tiny, pose), 1e-8);
    hits += expected;
  }
  EXPECT_GT(hits, 10);
  EXPECT_LT(hits, 90);
}

TEST(Scales, ThinBodies) {
  // Needles and sheets a million times as long as thick.
  const Mesh needle = scaled(random_soup(5, 20, 1, 1), {1e3, 1e-3, 1e-3}),
             sheet = scaled(random_soup(6, 40, 1, 1), {1, 1, 1e-6});
  EXPECT_GT(expect_as_brute_force(needle, sheet, 60, 1, {}, 5).hits, 3);
  expect_as_brute_force(sheet, sheet, 60, 0.7, {}, 6);
  expect_as_brute_force(needle, needle, 60, 1, {}, 7);
}

TEST(Scales, RotationsOfSinglePrecision) {
  const Tally tally =
      expect_as_brute_force(ball_mesh(1, 4), random_soup(3, 60, 0.7, 0.4), 100, 1.5, {10, -20, 30}, 8, true);
  EXPECT_GT(tally.hits, 20);
  EXPECT_GT(tally.frees, 20);
}

TEST(Scales, SweepsFarAwayAndOfSinglePrecision) {
  const Mesh a = ball_mesh(1, 3), b = random_soup(3, 15, 0.5, 0.4);
  const Body model_a(a), model_b(b);
  Random random(9);
  for (const double far : {0.0, 1e6, 1e9}) {
    const Vec3 at{far, -far / 3, far / 7};
    const double tolerance = 1e-3;
    int hits = 0;
    for (int n = 0; n < 60; ++n) {
      SCOPED_TRACE(n);
      const auto drawn = [&](double half) {
        Pose pose = random_pose(random, half);
        for (double& r : pose.rotation) r = static_cast<float>(r);
        pose.translation = pose.translation + at;
        return pose;
      };
      const Pose rest = drawn(0.5);
      const RigidMotion motion{drawn(3), drawn(3), {}};
      const SweepResult swept = sweep(model_a, rest, model_b, motion, {tolerance});
      for (int k = 0; k < 30; ++k) {
        if (swept.hit && swept.time == 0) break;
        EXPECT_FALSE(brute_touch(a, rest, b, pose_at(motion, swept.time * k / 30)));
      }
      if (!swept.hit) continue;
      ++hits;
      EXPECT_LE(brute_pair_distance(a, rest, b, pose_at(motion, swept.time)), tolerance * (1 + 1e-9) + 1e-15 * far);
    }
    EXPECT_GT(hits, 10) << far;
  }
}

}  // namespace
}  // namespace standoff
