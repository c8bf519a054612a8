// SPDX-License-Identifier: Apache-2.0
// Motions that turn further than the shorter rotation, and paths of motions: known times, and exact queries at many
// times of them.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "standoff/collision.h"
#include "tests/collision/bodies.h"

namespace standoff {
namespace {

using namespace standoff::testing;

constexpr double kTwoPi = 2 * std::numbers::pi;
constexpr Vec3 kUp{0, 0, 1};

void expect_same_bits(const SweepResult& found, const SweepResult& expected) {
  EXPECT_EQ(found.hit, expected.hit);
  EXPECT_EQ(found.finished, expected.finished);
  EXPECT_EQ(found.time, expected.time);
  EXPECT_EQ(found.triangle_a, expected.triangle_a);
  EXPECT_EQ(found.triangle_b, expected.triangle_b);
  EXPECT_EQ(found.point, expected.point);
  EXPECT_EQ(found.normal, expected.normal);
}

// No pose before the time of impact intersects; at that time the bodies are within the tolerance.
void expect_sound(const Body& a, const Pose& pose_a, const Body& b, const RigidMotion& motion, const SweepResult& swept,
                  double tolerance) {
  constexpr int kTimes = 2000;
  for (int k = 0; k <= kTimes; ++k) {
    const double t = swept.time * k / kTimes;
    if (swept.hit && (k == kTimes || swept.time == 0)) break;
    ASSERT_FALSE(collide(a, pose_a, b, pose_at(motion, t)).hit()) << "at " << t << " before " << swept.time;
  }
  if (!swept.hit) return;
  const Pose at = pose_at(motion, swept.time);
  ASSERT_LE(brute_pair_distance(a.mesh(), pose_a, b.mesh(), at), tolerance * (1 + 1e-9));
}

RigidMotion random_screw(Random& random, double half, double most_turns, double along) {
  const double angle_rad = random.between(-kTwoPi * most_turns, kTwoPi * most_turns);
  const Pose start = random_pose(random, half);
  const Vec3 point = start.translation + random.in_cube(0.5), axis = random.in_cube(1) + Vec3{1e-3, 0, 0};
  RigidMotion motion = screw_motion(start, point, axis, angle_rad, random.between(-along, along));
  motion.end.translation = motion.end.translation + random.in_cube(0.5);  // not along the axis alone
  return motion;
}

TEST(LongMotions, MissNoContact) {
  const Body ball(ball_mesh(1, 3)), soup(random_soup(3, 40, 1, 0.5)), small(random_soup(4, 15, 0.3, 0.4)),
      tiny(random_soup(5, 15, 0.05, 0.06));
  struct Pair {
    const Body &a, &b;
  };
  constexpr double kTolerance = 1e-3;
  Random random(41);
  for (const Pair& pair :
       {Pair{ball, small}, Pair{soup, small}, Pair{small, soup}, Pair{ball, tiny}, Pair{tiny, ball}}) {
    int hits = 0, frees = 0;
    for (int n = 0; n < 50; ++n) {
      SCOPED_TRACE("case " + std::to_string(n));
      const Pose pose_a = n % 2 == 0 ? Pose{} : random_pose(random, 2);
      RigidMotion motion = random_screw(random, 1.6, 4, 3);
      for (Pose* pose : {&motion.start, &motion.end}) pose->translation = pose->translation + pose_a.translation;
      const SweepResult swept = sweep(pair.a, pose_a, pair.b, motion, {.tolerance = kTolerance});
      expect_sound(pair.a, pose_a, pair.b, motion, swept, kTolerance);
      if (HasFatalFailure()) return;
      hits += swept.hit && swept.time > 0;
      frees += !swept.hit;
    }
    EXPECT_GT(hits, 5);
    EXPECT_GT(frees, 2);
  }
}

// A rod turns 3.25 times and rises by 0.4 a turn. A post stands at 45 degrees and begins at height 1.1: the rod passes
// below it at 0.05, 0.45 and 0.85, and meets it in the fourth turn, at 1.25.
TEST(LongMotions, ARodMeetsAPostInTheFourthTurn) {
  constexpr double kTurns = 3.25, kRise = 0.4, kExpected = 3.125 / kTurns, kTolerance = 1e-5;
  const Body rod(one_triangle({0.2, 0, 0}, {1, 0, 0}, {1, 0, 0.01}));
  for (const double side : {1.0, -1.0}) {
    const double c = std::sqrt(0.5), s = side * c, turn = side * kTwoPi * kTurns;
    const Body post(one_triangle({0.9 * c, 0.9 * s, 1.1}, {0.9 * c, 0.9 * s, 2}, {0.95 * c, 0.95 * s, 1.5}));
    const RigidMotion rod_moves = screw_motion({}, {0, 0, 7}, kUp * 3, turn, kRise * kTurns),
                      post_moves = screw_motion({}, {}, kUp * -0.1, turn, kRise * kTurns);
    for (const SweepResult& swept :
         {sweep(post, {}, rod, rod_moves, {kTolerance}), sweep(rod, {}, post, post_moves, {kTolerance})}) {
      ASSERT_TRUE(swept.hit);
      EXPECT_LE(swept.time, kExpected + 1e-12);
      EXPECT_GE(swept.time, kExpected - 2 * kTolerance / (0.9 * kTwoPi * kTurns));
    }
    // Turned less it stops before, and the shorter rotation between the same two poses is a quarter turn.
    EXPECT_FALSE(sweep(post, {}, rod, screw_motion({}, {}, kUp, side * kTwoPi * 3.1, kRise * 3.1), {kTolerance}).hit);
    EXPECT_FALSE(sweep(post, {}, rod, {rod_moves.start, rod_moves.end, rod_moves.center}, {kTolerance}).hit);
  }
}

// Threads of a bolt and of a nut: strips along a helix, half a pitch apart.
TEST(LongMotions, ANutTurnsOnItsBolt) {
  constexpr double kPitch = 0.3;
  const auto thread = [](double inner, double outer, double turns, double lift) {
    Mesh mesh;
    const auto at = [&](double radius, int n) {
      const double angle = n * kTwoPi / 24;
      return Vec3{radius * std::cos(angle), radius * std::sin(angle), kPitch * (n / 24.0) + lift};
    };
    for (int n = 0; n < 24 * turns; ++n) {
      add_triangle(mesh, at(inner, n), at(outer, n), at(outer, n + 1));
      add_triangle(mesh, at(inner, n), at(outer, n + 1), at(inner, n + 1));
    }
    return mesh;
  };
  const Body bolt(thread(0.6, 1.2, 9, 0)), nut(thread(1, 1.6, 2, kPitch / 2));
  for (const double turns : {5.5, 0.75}) {
    const RigidMotion along = screw_motion({}, {}, kUp, kTwoPi * turns, kPitch * turns);
    const SweepResult turning = sweep(bolt, {}, nut, along);
    EXPECT_FALSE(turning.hit) << "at " << turning.time;
    EXPECT_FALSE(sweep(nut, {}, bolt, screw_motion({}, {}, kUp, -kTwoPi * turns, -kPitch * turns)).hit);
    // Without the advance, or against it, the threads meet in half a turn or a quarter.
    EXPECT_NEAR(sweep(bolt, {}, nut, screw_motion({}, {}, kUp, kTwoPi * turns)).time * turns, 0.5, 0.05);
    EXPECT_NEAR(sweep(bolt, {}, nut, screw_motion({}, {}, kUp, -kTwoPi * turns, kPitch * turns)).time * turns, 0.25,
                0.05);
  }
}

TEST(LongMotions, HundredsAndMillionsOfTurns) {
  const Body post(one_triangle({0.9, 0, 0}, {0.9, 0, 1}, {0.95, 0, 0.5})),
      rod(one_triangle({0.2, 0, -1}, {1, 0, -1}, {1, 0, -1.01}));
  constexpr double kTurns = 300.5, kRise = 1.01;
  const SweepResult swept = sweep(post, {}, rod, screw_motion(make_pose(kUp, 1, {}), {}, kUp, kTwoPi * kTurns, kRise));
  ASSERT_TRUE(swept.hit);
  EXPECT_NEAR(swept.time, 1 / kRise, 1 / kTurns);
  const Pose beside{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {2.5, 0, 1}};
  // What the rotation keeps shows at once that a rod beside the post never meets it.
  const RigidMotion farthest = screw_motion(beside, {2.5, 0, 0}, kUp, kMaxTurnRad);
  EXPECT_FALSE(sweep(post, {}, rod, farthest).hit);
  EXPECT_TRUE(sweep(post, {}, rod, farthest, {0, 1000}).finished);
}

TEST(LongMotions, PosesAndTheirShorterRotation) {
  Random random(3);
  for (int n = 0; n < 100; ++n) {
    const Pose start = random_pose(random, 3);
    const Vec3 axis = random.in_cube(1) + Vec3{1e-3, 0, 0}, point = random.in_cube(2);
    const double angle_rad = random.between(-20, 20), along = random.between(-2, 2), t = random.between(0, 1);
    const RigidMotion motion = screw_motion(start, point, axis * 1e-200, angle_rad, along);
    // By the definition of a screw: about the point, in the world.
    const Pose turn = make_pose(axis, angle_rad * t, axis * (along * t / length(axis)) + point);
    const Pose found = pose_at(motion, t), expected = compose(turn, compose(moved(point * -1.0), start));
    for (std::size_t k = 0; k < 9; ++k) ASSERT_NEAR(found.rotation[k], expected.rotation[k], 1e-13);
    ASSERT_LT(length(found.translation - expected.translation), 1e-12);
    EXPECT_EQ(pose_at(motion, 0), start);
    EXPECT_EQ(pose_at(motion, 1), motion.end);
    if (std::abs(angle_rad) > 3.1) continue;
    const Pose shorter = pose_at({motion.start, motion.end, motion.center}, t);
    ASSERT_LT(length(found.translation - shorter.translation), 1e-11);
  }
}

TEST(LongMotions, ErrorsSayWhatIsWrong) {
  const Body body(one_triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}));
  const auto expect_usage = [](const std::string& words, const auto& call) {
    try {
      call();
      FAIL() << "no error: " << words;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::usage);
      EXPECT_NE(std::string(error.what()).find(words), std::string::npos) << error.what();
    }
  };
  const double nan = std::nan(""), infinity = std::numeric_limits<double>::infinity();
  expect_usage("axis", [&] { screw_motion({}, {}, {}, 1); });
  expect_usage("axis", [&] { screw_motion({}, {}, {nan, 0, 0}, 1); });
  expect_usage("finite", [&] { screw_motion({}, {infinity, 0, 0}, kUp, 1); });
  expect_usage("finite", [&] { screw_motion({}, {}, kUp, 1, nan); });
  expect_usage("1e+15", [&] { screw_motion({}, {}, kUp, 1, 1e300); });
  for (const double angle_rad : {nan, infinity, 2 * kMaxTurnRad, -2 * kMaxTurnRad}) {
    expect_usage("radians", [&] { screw_motion({}, {}, kUp, angle_rad); });
    expect_usage("radians", [&] { sweep(body, {}, body, {{}, {}, {}, kUp, angle_rad}); });
  }
  const RigidMotion no_axis{{}, {}, {}, {}, 7}, other_end{{}, {}, {}, kUp, 7}, odd_axis{{}, {}, {}, {0, nan, 1}, 0};
  for (const auto& [words, motion] :
       {std::pair{"no axis", no_axis}, std::pair{"matrices differ", other_end}, std::pair{"not finite", odd_axis}}) {
    expect_usage(words, [&] { pose_at(motion, 0.5); });
    expect_usage(words, [&] { sweep(body, {}, body, motion); });
    expect_usage(words, [&] { sweep_all(body, {}, body, std::vector{motion}); });
    expect_usage(words, [&] { sweep_path(body, {}, body, std::vector{motion}); });
  }
}

TEST(Paths, OneMotionIsASweep) {
  const Body soup(random_soup(3, 40, 1, 0.5)), small(random_soup(4, 15, 0.3, 0.4));
  Random random(42);
  int hits = 0;
  for (int n = 0; n < 60; ++n) {
    const RigidMotion screw = random_screw(random, 1.6, 1.5, 3), shorter{screw.start, screw.end, screw.center};
    for (const RigidMotion& motion : {screw, shorter})
      for (const std::int64_t most : {0, 20}) {
        const SweepOptions options{.tolerance = 1e-3, .max_steps = most};
        const SweepResult expected = sweep(soup, {}, small, motion, options);
        const PathSweepResult found = sweep_path(soup, {}, small, std::vector{motion}, options);
        expect_same_bits(found.sweep, expected);
        EXPECT_EQ(found.motion, 0);
        hits += expected.hit;
      }
  }
  EXPECT_GT(hits, 20);
}

// A path through poses: the first motion that hits, and no pose of those before intersects.
TEST(Paths, ManyMotionsMissNoContact) {
  const Body soup(random_soup(3, 40, 1, 0.5)), small(random_soup(4, 15, 0.3, 0.4));
  constexpr double kTolerance = 1e-3;
  Random random(43);
  std::vector<int> ends(4);
  for (int n = 0; n < 200; ++n) {
    SCOPED_TRACE("path " + std::to_string(n));
    std::vector<RigidMotion> path;
    Pose at = random_pose(random, 3.5);
    for (int k = 0; k < 3; ++k) {
      RigidMotion next;
      if (k == 1) {
        next = screw_motion(at, at.translation + random.in_cube(2), random.in_cube(1) + Vec3{1e-3, 0, 0},
                            random.between(-9, 9), 0.3);
      } else {
        next = {at, random_pose(random, 3.5), random.in_cube(0.3)};
      }
      path.push_back(next), at = next.end;
    }
    const PathSweepResult found = sweep_path(soup, {}, small, path, {.tolerance = kTolerance});
    for (std::int64_t k = 0; k <= found.motion; ++k) {
      const RigidMotion& motion = path[static_cast<std::size_t>(k)];
      expect_sound(soup, {}, small, motion, k < found.motion ? SweepResult{} : found.sweep, kTolerance);
      if (HasFatalFailure()) return;
    }
    ++ends[found.sweep.hit ? static_cast<std::size_t>(found.motion) : 3];
    EXPECT_TRUE(found.sweep.hit || found.motion == 2);
  }
  for (const int count : ends) EXPECT_GT(count, 2) << ends[0] << " " << ends[1] << " " << ends[2] << " " << ends[3];
}

TEST(Paths, ContactAtAJoint) {
  const Body floor(one_triangle({-9, -9, 0}, {9, -9, 0}, {0, 9, 0})),
      box(one_triangle({0, 0, 0}, {0.1, 0, 0.1}, {0, 0.1, 0.1}));
  constexpr double kTolerance = 1e-4;
  const auto at = [](double height) { return moved({0, 0, height}); };
  const auto path_by = [&](double height, double to) {
    return std::vector<RigidMotion>{{at(1), at(height), {}}, {at(height), at(to), {}}};
  };
  // The joint touches the floor.
  const PathSweepResult touch = sweep_path(floor, {}, box, path_by(0, 1), {kTolerance});
  ASSERT_TRUE(touch.sweep.hit);
  EXPECT_EQ(touch.motion, 0);
  EXPECT_GE(touch.sweep.time, 1 - kTolerance);
  // It is nearer than the tolerance, and the path goes on through the floor: a hit, wherever it is seen.
  for (const double share : {0.3, 0.6, 0.9}) {
    const double height = share * kTolerance;
    const PathSweepResult through = sweep_path(floor, {}, box, path_by(height, -1), {kTolerance});
    ASSERT_TRUE(through.sweep.hit);
    EXPECT_LE(static_cast<double>(through.motion) + through.sweep.time, 1 + height);
  }
  // It is farther than the tolerance: free if the path turns back there, a hit of motion 1 if it does not.
  EXPECT_FALSE(sweep_path(floor, {}, box, path_by(2 * kTolerance, 1), {kTolerance}).sweep.hit);
  const PathSweepResult later = sweep_path(floor, {}, box, path_by(2 * kTolerance, -1), {kTolerance});
  ASSERT_TRUE(later.sweep.hit);
  EXPECT_EQ(later.motion, 1);
  EXPECT_GT(later.sweep.time, 0);
  EXPECT_LT(later.sweep.time, 3 * kTolerance);
}

TEST(Paths, StepsAreCountedOverTheWholePath) {
  const Body soup(random_soup(3, 40, 1, 0.5)), small(random_soup(4, 15, 0.3, 0.4));
  // There and back, past the soup.
  const Pose left = moved({-1.5, 2.1, 0}), right = make_pose(kUp, 2, {1.5, 2.1, 0});
  const std::vector<RigidMotion> path{{left, right, {}}, {right, left, {}}, {left, right, {}}};
  ASSERT_FALSE(sweep_path(soup, {}, small, path).sweep.hit);
  std::int64_t enough_for_one = 1;
  while (!sweep(soup, {}, small, path[0], {.max_steps = enough_for_one}).finished) ++enough_for_one;
  ASSERT_GT(enough_for_one, 5);
  double before = 0;
  bool in_between = false;
  for (std::int64_t most = 1;; ++most) {
    const PathSweepResult found = sweep_path(soup, {}, small, path, {.max_steps = most});
    EXPECT_FALSE(found.sweep.hit);
    const double end = static_cast<double>(found.motion) + found.sweep.time;
    EXPECT_GE(end, before);
    before = end;
    EXPECT_EQ(found.motion == 0 && !found.sweep.finished, most < enough_for_one);
    in_between |= found.motion == 1;
    if (!found.sweep.finished) continue;
    EXPECT_GE(most, 2 * enough_for_one);
    EXPECT_EQ(end, 3);
    break;
  }
  EXPECT_TRUE(in_between);
}

TEST(Paths, AMotionBeginsWhereTheLastOneEnds) {
  const Body body(one_triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}));
  constexpr double kTolerance = 1e-3;
  const auto path_with = [](double jump, double turn) {
    std::vector<RigidMotion> path(4);
    for (std::size_t n = 0; n < 4; ++n) {
      path[n].start = moved({0, 0, 3.0 + static_cast<double>(n)});
      path[n].end = moved({0, 0, 4.0 + static_cast<double>(n)});
    }
    path[2].start = path[2].end = make_pose(kUp, turn, path[2].start.translation + Vec3{jump, 0, 0});
    path[3].start = path[3].end = path[2].end;
    return path;
  };
  const auto swept = [&](const std::vector<RigidMotion>& path) {
    return sweep_path(body, {}, body, path, {kTolerance});
  };
  for (const auto& [jump, turn] : {std::pair{0.0, 0.0}, std::pair{2e-4, 0.0}, std::pair{0.0, 1e-5}})
    EXPECT_FALSE(swept(path_with(jump, turn)).sweep.hit);
  for (const auto& [jump, turn] : {std::pair{3e-4, 0.0}, std::pair{0.0, 1e-3}, std::pair{2.0, 2.0}}) try {
      swept(path_with(jump, turn));
      FAIL() << "no error";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::usage);
      EXPECT_NE(std::string(error.what()).find("motion 2 does not begin where motion 1 ends"), std::string::npos)
          << error.what();
    }
  EXPECT_THROW(swept({}), Error);
}

// A body may part from within the tolerance without a hit; a jump from there may pass through the other body.
TEST(Paths, AJumpThroughASurfaceIsAHit) {
  const Body floor(one_triangle({-9, -9, 0}, {9, -9, 0}, {0, 9, 0})),
      body(one_triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}));
  const std::vector<RigidMotion> path{{moved({0, 0, 1e-3}), moved({0, 0, 1.2e-3})},
                                      {moved({0, 0, -1e-3}), moved({0, 0, -5})}};
  const PathSweepResult found = sweep_path(floor, {}, body, path, {0.01});
  EXPECT_TRUE(found.sweep.hit);
  EXPECT_EQ(found.motion, 1);
  EXPECT_EQ(found.sweep.time, 0);
}

// The end may be turned a little where the angle is zero: points move on straight lines all the same, as pose_at() has
// them, and not with a centre far away.
TEST(LongMotions, AnAngleOfZeroWithATurnedEnd) {
  const Body ball(ball_mesh(0.002, 4, {0, -0.02, 0})), body(one_triangle({0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0}));
  const double turn = 9e-6;
  RigidMotion motion{{}, make_pose(kUp, turn, {0, -std::sin(turn) * 4000, 0}), {4000, 0, 0}, kUp, 0};
  const SweepResult swept = sweep(ball, {}, body, motion);
  ASSERT_TRUE(swept.hit);
  for (int n = 0; n <= 1000; ++n)
    if (n / 1000.0 < swept.time) ASSERT_FALSE(collide(ball, {}, body, pose_at(motion, n / 1000.0)).hit()) << n;
}

// The chord of a curve that comes back is short, but the curve is not.
TEST(Splines, AWayThatIsTooLongIsAnError) {
  const Body ball(ball_mesh(1, 4));
  SplineMotion motion;
  motion.start = moved({5, 0, 0});
  motion.control = {Vec3{1e15, 0, 0}, Vec3{1e15, 1, 0}, Vec3{5, 0, 0}};
  EXPECT_THROW(sweep_spline(ball, {}, ball, motion, {1e-9}), Error);
}

}  // namespace
}  // namespace standoff
