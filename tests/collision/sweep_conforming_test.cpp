// SPDX-License-Identifier: Apache-2.0
// Sweeps of surfaces that conform to each other, by the number of steps they take; and sweeps of bodies of thousands of
// triangles against exact answers at many times.
#include <gtest/gtest.h>

#include <vector>

#include "standoff/collision.h"
#include "tests/collision/bodies.h"
#include "tests/collision/solids.h"
#include "tests/support/expect_error.h"
#include "tests/support/sanitized.h"

namespace standoff {
namespace {

using namespace standoff::testing;

// Spheres and shafts take at most 8,192 steps, most of them before their orbits are found, and the plates one.
constexpr std::int64_t kTurningSteps = 10'000, kPlateSteps = 1;
constexpr double kHalfTurn = std::numbers::pi;

// A mesh of 2 * columns * rows triangles over the unit square.
template <class Position>
Mesh grid_mesh(int columns, int rows, Position position) {
  Mesh mesh;
  for (int row = 0; row <= rows; ++row)
    for (int column = 0; column <= columns; ++column)
      mesh.vertices.push_back(position(1.0 * column / columns, 1.0 * row / rows));
  const auto at = [&](int column, int row) { return static_cast<std::uint32_t>(row * (columns + 1) + column); };
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      mesh.triangles.push_back({at(column, row), at(column + 1, row), at(column + 1, row + 1)});
      mesh.triangles.push_back({at(column, row), at(column + 1, row + 1), at(column, row + 1)});
    }
  return mesh;
}

Mesh tube_mesh(double radius, double tall, int sides, int rings) {
  return grid_mesh(sides, rings, [&](double u, double v) {
    const double angle = 2 * std::numbers::pi * u;
    return Vec3{radius * std::cos(angle), radius * std::sin(angle), (v - 0.5) * tall};
  });
}

Mesh plate_mesh(double size, int cuts, double height) {
  return grid_mesh(cuts, cuts, [&](double u, double v) { return Vec3{(u - 0.5) * size, (v - 0.5) * size, height}; });
}

Mesh placed(Mesh mesh, const Pose& pose) {
  for (Vec3& v : mesh.vertices) v = apply(pose, v);
  return mesh;
}

// Checks that the sweep is free and takes at most so many steps, with either body moving.
void expect_free_within(const Mesh& mesh_a, const Mesh& mesh_b, const RigidMotion& motion, double tolerance,
                        std::int64_t steps) {
  const Body a(mesh_a), b(mesh_b);
  RigidMotion back = motion;
  back.end.rotation = {motion.end.rotation[0], motion.end.rotation[3], motion.end.rotation[6],
                       motion.end.rotation[1], motion.end.rotation[4], motion.end.rotation[7],
                       motion.end.rotation[2], motion.end.rotation[5], motion.end.rotation[8]};
  back.end.translation = -motion.end.translation;
  for (const SweepResult& swept :
       {sweep(a, {}, b, motion, {tolerance, steps}), sweep(b, {}, a, back, {tolerance, steps})}) {
    EXPECT_TRUE(swept.finished) << "at " << swept.time;
    EXPECT_FALSE(swept.hit) << "at " << swept.time;
  }
}

// Compares with exact answers at many times, also in steps that double from the time of the hit backwards.
void expect_true(const Body& a, const Pose& pose_a, const Body& b, const RigidMotion& motion,
                 const SweepOptions& options, const SweepResult& swept) {
  ASSERT_TRUE(swept.finished);
  std::vector<double> times;
  for (int k = 0; k < 40; ++k) times.push_back(swept.time * k / 40);
  for (double before = 1e-12; before < swept.time; before *= 4) times.push_back(swept.time - before);
  if (!swept.hit) times.push_back(1);
  if (swept.time == 0) times.clear();
  for (const double t : times)
    ASSERT_FALSE(collide(a, pose_a, b, pose_at(motion, t)).hit()) << "at " << t << " before " << swept.time;
  if (!swept.hit) return;
  EXPECT_LE(distance(a, pose_a, b, pose_at(motion, swept.time)).upper, options.tolerance * (1 + 1e-9));
}

// The bounds of speed alone make a sphere that turns in another one crawl, in steps of the clearance: such a sweep once
// took ten seconds.
TEST(ConformingSweep, ASphereTurnsInASphere) {
  const RigidMotion motion{{}, make_pose({0.3, 0.5, 0.8}, 170 * kHalfTurn / 180, {}), {}};
  expect_free_within(ball_mesh(1, 25), ball_mesh(0.99, 25), motion, 0, kTurningSteps);
}

TEST(ConformingSweep, AShaftTurnsInItsSleeve) {
  const RigidMotion motion{{}, make_pose({0, 0, 1}, 170 * kHalfTurn / 180, {}), {}};
  expect_free_within(tube_mesh(1.005, 6, 100, 25), tube_mesh(1, 6, 100, 25), motion, 0, kTurningSteps);
}

// Orbits tell nothing of what sticks out: a tooth on the shaft, and a stop in the sleeve, which meet after 100 degrees.
TEST(ConformingSweep, AToothOfAShaftMeetsAStop) {
  const auto fin = [](double degrees, double from, double to) {
    const double angle = degrees / 180 * kHalfTurn;
    const Vec3 out{std::cos(angle), std::sin(angle), 0}, up{0, 0, 0.1};
    Mesh mesh;
    mesh.vertices = {out * from - up, out * from + up, out * to};
    mesh.triangles = {{0, 1, 2}};
    return mesh;
  };
  const Body sleeve(joined({tube_mesh(1.005, 6, 100, 25), fin(100, 1.005, 1.001)}));
  const Body shaft(joined({tube_mesh(1, 6, 100, 25), fin(0, 1, 1.003)}));
  const RigidMotion motion{{}, make_pose({0, 0, 1}, 170 * kHalfTurn / 180, {}), {}};
  const SweepOptions options{1e-6, kTurningSteps};
  const SweepResult swept = sweep(sleeve, {}, shaft, motion, options);
  ASSERT_TRUE(swept.hit && swept.finished);
  EXPECT_NEAR(swept.time, 100.0 / 170, 1e-6);
  expect_true(sleeve, {}, shaft, motion, options, swept);
}

// A plate with three corners, centred on the axis, meets a pin beside the axis: such a plate reaches the axis, though
// its middle has no direction away from it. Axes that are not exact in floating point once made it seem to lie around
// it.
TEST(ConformingSweep, APlateAcrossTheAxisMeetsAPin) {
  Random random(271);
  for (int round = 0; round < 30; ++round) {
    Vec3 axis = random.in_cube(1);
    axis = axis * (1 / length(axis));
    const Vec3 first = cross(axis, std::abs(axis.x) < 0.5 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}),
               p = first * (1 / length(first)), q = cross(axis, p);
    const auto at = [&](double along, double radius, double degrees) {
      const double angle = degrees / 180 * kHalfTurn;
      return axis * along + p * (radius * std::cos(angle)) + q * (radius * std::sin(angle));
    };
    const auto tube = [&](double radius) {
      return grid_mesh(24, 1, [&](double u, double v) { return at(1 + 8 * v, radius, 360 * u); });
    };
    Mesh plate, pin;
    plate.vertices = {at(10, 0.3, 0), at(10, 0.3, 120), at(10, 0.3, 240)};
    pin.vertices = {at(10.3, 0.25, 60), at(9.7, 0.25, 60), at(10, 0.3, 60)};
    plate.triangles = pin.triangles = {{0, 1, 2}};
    const Body sleeve(joined({tube(0.501 / std::cos(kHalfTurn / 24)), pin})), shaft(joined({tube(0.5), plate}));
    const RigidMotion motion{{}, make_pose(axis, 2.9, {}), {}};
    const SweepOptions options{1e-6, 0};
    const SweepResult swept = sweep(sleeve, {}, shaft, motion, options);
    ASSERT_TRUE(swept.hit) << round;
    expect_true(sleeve, {}, shaft, motion, options, swept);
  }
}

// In single precision a gap of 1e-7 of the size is not seen, and all triangles are followed.
TEST(ConformingSweep, PlatesSlideAMillionthApart) {
  for (const Pose& pose : {Pose{}, make_pose({0.3, 0.2, 0.9}, 0.7, {0.1, 0.2, 0.3})}) {
    RigidMotion motion;
    motion.end.translation = rotate(pose, {3, 0, 0});
    expect_free_within(placed(plate_mesh(10, 50, 0), pose), placed(plate_mesh(10, 50, 1e-6), pose), motion, 1e-7,
                       kPlateSteps);
  }
}

TEST(ConformingSweep, PlatesOfAHundredThousandTriangles) {
  constexpr int kCuts = kSanitized ? 60 : 224;
  const Body a(plate_mesh(10, kCuts, 0)), b(plate_mesh(10, kCuts, 0));
  RigidMotion motion;
  // They start in one plane, and touch.
  motion.end.translation = {3, 0, 0};
  SweepResult swept = sweep(a, {}, b, motion, {1e-7, 1000});
  EXPECT_TRUE(swept.hit && swept.time == 0);
  // They do not move at all.
  swept = sweep(a, {}, b, RigidMotion{}, {1e-7, 1000});
  EXPECT_TRUE(swept.hit && swept.time == 0);
  // One falls onto the other.
  motion.start.translation = {0.3, 0.2, 1}, motion.end.translation = {0.3, 0.2, -1};
  swept = sweep(a, {}, b, motion, {1e-7, 100'000});
  ASSERT_TRUE(swept.hit);
  EXPECT_NEAR(swept.time, 0.5, 1e-7);
  EXPECT_LE(swept.time, 0.5);
}

struct Pair {
  const char* name;
  Mesh a, b;
  double start, way;  // how far from a's middle b starts, and how far it moves
};

TEST(Sweep, ThousandsOfTrianglesMeetWhereTheyTouch) {
  const Pair pairs[] = {
      {"balls", ball_mesh(1, 12), ball_mesh(0.7, 10), 2.5, 2.5},
      {"a small ball", ball_mesh(1, 20), ball_mesh(0.08, 5), 1.3, 1},
      {"soups", random_soup(11, 600, 1, 0.2), random_soup(12, 500, 0.7, 0.2), 2.5, 2.5},
      {"needles", random_soup(13, 400, 1, 0.9), random_soup(14, 300, 0.1, 0.9), 3, 3},
      {"a sphere in a sphere", ball_mesh(1, 16), ball_mesh(0.9, 14), 0, 0.2},
      {"tubes", tube_mesh(1.02, 3, 60, 8), tube_mesh(1, 3, 64, 9), 0, 0.02},
  };
  for (const Pair& pair : pairs) {
    SCOPED_TRACE(pair.name);
    const Body a(pair.a), b(pair.b);
    Random random(7);
    int hits = 0, frees = 0;
    for (int n = 0; n < 40; ++n) {
      SCOPED_TRACE("motion " + std::to_string(n));
      const Pose pose_a = n % 3 ? random_pose(random, 5) : Pose{};
      Vec3 side = random.in_cube(1);
      side = side * (1 / length(side));
      const double turn = n % 4 == 0 ? 0 : n % 4 == 1 ? kHalfTurn : random.between(0, 2);
      const Pose from = pair.start > 0 ? make_pose(random.in_cube(1), random.between(0, 3), side * pair.start) : Pose{};
      const Pose delta = make_pose(random.in_cube(1), pair.start > 0 ? turn : turn / 4, {});
      RigidMotion motion{compose(pose_a, from), {}, pair.start > 0 ? random.in_cube(0.4) : Vec3{}};
      Pose to = from;
      to.rotation = compose(delta, from).rotation;
      to.translation = from.translation - (side + random.in_cube(0.5)) * (random.between(0, 1.5) * pair.way);
      motion.end = compose(pose_a, to);
      for (const SweepOptions options : {SweepOptions{1e-3}, SweepOptions{1e-7}}) {
        const bool swap = n % 2;
        const Pose at = swap ? motion.start : pose_a;
        RigidMotion moves = motion;
        if (swap) moves = {pose_a, compose(make_pose(random.in_cube(1), turn, random.in_cube(pair.way)), pose_a), {}};
        const SweepResult swept = swap ? sweep(b, at, a, moves, options) : sweep(a, at, b, moves, options);
        swap ? expect_true(b, at, a, moves, options, swept) : expect_true(a, at, b, moves, options, swept);
        if (HasFatalFailure()) return;
        hits += swept.hit;
        frees += !swept.hit;
      }
    }
    EXPECT_GE(hits, 4);
    EXPECT_GE(frees, 3);
  }
}

// The world's coordinates are rounded by 1e-7 here, and the sweep must leave that between the bodies.
TEST(Sweep, BodiesABillionFromTheOriginDoNotPassEachOther) {
  const Body a(ball_mesh(1, 12)), b(ball_mesh(0.7, 10));
  const Vec3 far{1e9, -2e9, 1.5e9};
  Random random(3);
  for (int n = 0; n < 20; ++n) {
    const Vec3 side = random.in_cube(1), way = side * (2.5 / length(side));
    RigidMotion motion{moved(far + way), make_pose(random.in_cube(1), 2, far - way), {}};
    const SweepResult swept = sweep(a, moved(far), b, motion, {1e-9});
    ASSERT_TRUE(swept.hit);
    for (int k = 0; k < 50; ++k) ASSERT_FALSE(collide(a, moved(far), b, pose_at(motion, swept.time * k / 50)).hit());
    EXPECT_LE(distance(a, moved(far), b, pose_at(motion, swept.time)).upper, 1e-4);
  }
}

TEST(Sweep, EndsUnfinishedAfterTheMostSteps) {
  const Body a(ball_mesh(1, 25)), b(ball_mesh(0.99, 25));
  const RigidMotion motion{{}, make_pose({0.3, 0.5, 0.8}, 3, {0.02, 0, 0}), {}};
  const SweepResult whole = sweep(a, {}, b, motion);
  ASSERT_TRUE(whole.hit && whole.finished);
  double before = 0;
  int unfinished = 0;
  for (const std::int64_t steps : {1, 100, 10'000, 30'000, 100'000, 300'000, 1'000'000}) {
    const SweepResult swept = sweep(a, {}, b, motion, {0, steps});
    EXPECT_GE(swept.time, before);
    EXPECT_LE(swept.time, whole.time);
    before = swept.time;
    unfinished += !swept.finished;
    if (swept.finished) {
      EXPECT_EQ(swept.time, whole.time);
    } else {
      EXPECT_FALSE(swept.hit);
      EXPECT_EQ(swept.triangle_a, kNoTriangle);
    }
  }
  EXPECT_GE(unfinished, 3);
  EXPECT_EQ(before, whole.time);
  expect_error(
      [&] {
        sweep(a, {}, b, motion, {0, -1});
      },
      ErrorCode::usage, "sweep: max_steps must not be negative; give 0 for no limit");
}

// A slender rod whose axis is longer than one in single precision: its corners are farther from the center than the
// half diagonal of its box. A bound of their speed by that alone let the rod turn through a triangle.
TEST(Sweep, OfARodWhoseAxisIsRounded) {
  Random random(1);
  double longest = 0, angle = 0;
  for (int n = 0; n < 100'000; ++n) {
    const double at = random.between(0, kHalfTurn / 2);
    const double grows = std::hypot(double{float(std::cos(at))}, double{float(std::sin(at))}) - 1;
    if (grows > longest) longest = grows, angle = at;
  }
  const Vec3 along{std::cos(angle), std::sin(angle), 0}, across{-along.y, along.x, 0}, up{0, 0, 1e-14};
  const double half = 1.95, wide = 1e-6 * half, turn = 2e-3;
  const Body rod(Mesh{{along * half, along * -half, across * wide, across * -wide, up, up * -1.0},
                      {{0, 1, 2}, {0, 3, 1}, {0, 1, 4}, {0, 5, 1}}});
  RigidMotion motion;
  motion.end = make_pose({along.y, -along.x, 0}, turn, {});
  for (int n = 0; n < 100; ++n) {
    // Of the height where the bound was most wrong.
    const double height = half * std::sqrt(2 * longest) * random.between(0.3, 1.5);
    const Vec3 tip = along * (half * 0.99999) + Vec3{0, 0, height};
    const Body wall(
        Mesh{{tip + Vec3{-half, -half, 0}, tip + Vec3{half, -half, 0}, tip + Vec3{0, half, 0}}, {{0, 1, 2}}});
    const double touch = std::asin(height / half) / turn;
    for (const double tolerance : {1e-12, 1e-14}) {
      const SweepResult swept = sweep(wall, {}, rod, motion, {.tolerance = tolerance});
      ASSERT_TRUE(swept.hit) << n;
      EXPECT_LE(swept.time, touch * (1 + 1e-15)) << n;
    }
  }
}

// Bodies that rest within the tolerance are looked at once, which takes 35,000 steps here; before, it took thirty times
// as long.
TEST(Sweep, OfBodiesThatRestTakesFewSteps) {
  const Mesh plate = plate_mesh(10, 30, 0);
  Pose above;
  above.translation = {0, 0, 5e-5};
  expect_free_within(plate, placed(plate, above), {}, 1e-4, 100'000);
}

}  // namespace
}  // namespace standoff
