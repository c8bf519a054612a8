// SPDX-License-Identifier: Apache-2.0
// The fly in the labyrinth against answers found by another method (independent.h). A few hundred questions by default;
// for as many as docs/collision.md tells of, run this program with the environment variables below.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>

#include "scenes/scenes.h"
#include "standoff/collision.h"
#include "tests/collision/bodies.h"
#include "tests/collision/independent.h"

namespace standoff {
namespace {

using namespace standoff::testing;

// STANDOFF_CHECK_POSES, STANDOFF_CHECK_SWEEPS: how many; STANDOFF_CHECK_SEED: which.
long from_environment(const char* name, long otherwise) {
  const char* const text = std::getenv(name);
  return text == nullptr ? otherwise : std::atol(text);
}

// Prints the progress of a long run.
void tell(const char* what, long done, long all) {
  if (done > 0 && done % 100'000 == 0) std::fprintf(stderr, "%ld of %ld %s\n", done, all, what);
}

struct Labyrinth : ::testing::Test {
  // Coarser walls for a few questions: the sanitizers take long to build the body of the fine ones.
  static inline const bool asked =
      std::getenv("STANDOFF_CHECK_POSES") != nullptr || std::getenv("STANDOFF_CHECK_SWEEPS") != nullptr;
  static inline const Mesh walls = scenes::make("labyrinth", asked ? 0 : 30'000), fly = scenes::make("fly");
  static inline const Body model{walls}, flier{fly};
  IndependentBody still{walls}, moving{fly};
  Random random{static_cast<unsigned>(from_environment("STANDOFF_CHECK_SEED", 1))};

  Pose pose_inside() {
    const Box box = model.bounds();
    Pose pose = make_pose(random.in_cube(1) + Vec3{0, 0, 1e-3}, random.between(0, 2 * std::numbers::pi), {});
    const Vec3 at{random.between(box.min.x, box.max.x), random.between(box.min.y, box.max.y),
                  random.between(box.min.z, box.max.z)};
    pose.translation = at - rotate(pose, flier.bounds().center());
    return pose;
  }
  bool touches_at(const Pose& pose) {
    moving.place(pose);
    return moving.touches(still);
  }
};

TEST_F(Labyrinth, PosesAgreeWithAnIndependentExactTest) {
  const long poses = from_environment("STANDOFF_CHECK_POSES", 400);
  long hits = 0, ambiguous = 0;
  for (long n = 0; n < poses; ++n) {
    tell("poses", n, poses);
    const Pose pose = pose_inside();
    const bool expected = touches_at(pose);
    const CollisionResult found = collide(model, {}, flier, pose);
    ASSERT_EQ(found.hit(), expected) << "pose " << n;
    if (expected) {
      ASSERT_TRUE(independent_touch(still.triangle(found.triangle_a), moving.triangle(found.triangle_b)));
    }
    ASSERT_EQ(collide(flier, pose, model, {}).hit(), expected) << "pose " << n << ", turned round";
    const Verdict certified = collide(model, {}, flier, pose, {.mode = CollideMode::certified}).verdict;
    ASSERT_TRUE(certified == Verdict::ambiguous || (certified == Verdict::hit) == expected) << "pose " << n;
    ambiguous += certified == Verdict::ambiguous;
    hits += expected;
    if (n % 16 != 0) continue;
    ASSERT_EQ(distance(model, {}, flier, pose).upper == 0, expected) << "pose " << n;
    const ContactResult some = contacts(model, {}, flier, pose, {.most = 20});
    ASSERT_EQ(!some.contacts.empty(), expected) << "pose " << n;
    for (const ContactPoint& it : some.contacts)
      ASSERT_TRUE(independent_touch(still.triangle(it.triangle_a), moving.triangle(it.triangle_b))) << "pose " << n;
  }
  std::printf("%ld poses, %ld touching, %ld free, %ld ambiguous to the field alone; none differs\n", poses, hits,
              poses - hits, ambiguous);
  EXPECT_GT(hits, poses / 5);
  EXPECT_LT(hits, poses * 4 / 5);
}

TEST_F(Labyrinth, SweepsMissNothing) {
  const long sweeps = from_environment("STANDOFF_CHECK_SWEEPS", 100);
  constexpr double kTolerance = 1e-4, kRounding = 1e-9;
  long hits = 0, turning = 0, sampled = 0, straight_hits = 0, seen = 0;
  for (long n = 0; n < sweeps; ++n) {
    tell("sweeps", n, sweeps);
    SCOPED_TRACE("sweep " + std::to_string(n));
    RigidMotion motion;
    do motion.start = pose_inside();
    while (touches_at(motion.start));
    // Paths of length 0.02 to 10, as many short as long ones.
    const double speed = 0.02 * std::pow(500, random.between(0, 1));
    const Vec3 direction = random.in_cube(1) + Vec3{0, 0, 1e-3};
    const bool turns = n % 5 == 0;
    motion.center = flier.bounds().center();
    motion.end = motion.start;
    if (turns) {
      const Pose turn = make_pose(random.in_cube(1) + Vec3{1e-3, 0, 0}, random.between(0, 3), {});
      motion.end.rotation = compose(turn, motion.start).rotation;
    }
    motion.end.translation = apply(motion.start, motion.center) + direction * (speed / length(direction)) -
                             rotate(motion.end, motion.center);
    const SweepResult swept = sweep(model, {}, flier, motion, {.tolerance = kTolerance});
    hits += swept.hit;
    if (turns) {
      // Test positions on the path, one per length of a thin part of the fly, and always some.
      ++turning;
      const int times = 12 + static_cast<int>(speed * 4);
      for (int k = 1; k <= times; ++k) {
        const double t = swept.time * (k - random.between(0, 1)) / times;
        ASSERT_FALSE(touches_at(pose_at(motion, t))) << "at " << t << " before " << swept.time;
        ++sampled;
      }
    } else {
      moving.place(motion.start);
      const Vec3 translation = motion.end.translation - motion.start.translation;
      ASSERT_FALSE(moving.passes_through(still, translation * swept.time, kRounding)) << "before " << swept.time;
      // A check that sees nothing would pass everything: it must see the walls that the whole path passes through.
      if (swept.hit) {
        ++straight_hits;
        moving.place(motion.start);
        seen += moving.passes_through(still, translation, kRounding);
      }
    }
    if (!swept.hit) continue;
    moving.place(pose_at(motion, swept.time));
    const auto p = moving.triangle(swept.triangle_b), q = still.triangle(swept.triangle_a);
    ASSERT_TRUE(independent_touch(p, q) || gap_of(p, q) <= kTolerance * (1 + 1e-6)) << gap_of(p, q);
  }
  std::printf(
      "%ld sweeps of 0.02 to 10, %ld of them turning (%ld places tested), %ld hits; none missed (%ld of %ld straight "
      "hits lead through)\n",
      sweeps, turning, sampled, hits, seen, straight_hits);
  EXPECT_GT(seen, straight_hits * 9 / 10);  // the others only come within the tolerance
  EXPECT_GT(hits, sweeps / 20);
  EXPECT_LT(hits, sweeps * 9 / 10);
}

}  // namespace
}  // namespace standoff
