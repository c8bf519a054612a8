// SPDX-License-Identifier: Apache-2.0
// What a rotation keeps: triangles that orbits keep apart are apart at every time of the motion.
#include "collision/orbits.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "geometry/triangle_pair.h"
#include "tests/support/random_mesh.h"

namespace standoff::collision {
namespace {

Corners moved(const Corners& corners, const Orbits& orbits, Vec3 velocity, double angle, double t) {
  Corners at;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 arm = corners[k] - orbits.center;
    const double cosine = std::cos(angle * t), sine = std::sin(angle * t);
    at[k] = orbits.center + velocity * t + arm * cosine + cross(orbits.axis, arm) * sine +
            orbits.axis * (dot(orbits.axis, arm) * (1 - cosine));
  }
  return at;
}

// A middle on the axis has no direction away from it, and one near it none but rounding.
TEST(Orbits, BoundsOfATriangleAroundTheAxis) {
  testing::Random random(812);
  for (int round = 0; round < 2000; ++round) {
    Vec3 axis = random.in_cube(1);
    axis = axis * (1 / length(axis));
    const Vec3 first = cross(axis, std::abs(axis.x) < 0.5 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}),
               p = first * (1 / length(first)), q = cross(axis, p);
    Corners corners;
    const double off = round % 2 == 0 ? 0 : std::pow(10.0, -6 - round % 9);
    for (int k = 0; k < 3; ++k) {
      const double angle = 2 * std::numbers::pi * k / 3;
      corners[static_cast<std::size_t>(k)] =
          axis * 10 + p * (0.5 * std::cos(angle) + off) + q * (0.5 * std::sin(angle));
    }
    const OrbitBounds bounds = Orbits{.axis = axis}.bounds(corners);
    ASSERT_LE(bounds.from_axis.low, 1e-14) << round;  // the axis passes through the triangle
    ASSERT_LE(bounds.from_center.low, 10 + 1e-12);
    ASSERT_GE(bounds.from_axis.high, 0.5 - 1e-12);
  }
}

// Of each rule by itself, and of all together: whether pairs that they keep apart are farther apart than `keep` at 60
// times of the motion. Each rule must know some such pair.
TEST(Orbits, TrianglesThatTheyKeepApartNeverMeet) {
  testing::Random random(811);
  std::array<int, 3> known{};
  for (int round = 0; round < 20'000; ++round) {
    const auto triangle = [&](double size) {
      const Vec3 at = random.in_cube(1);
      return Corners{at + random.in_cube(size), at + random.in_cube(size), at + random.in_cube(size)};
    };
    const double size = round % 3 == 0 ? 1.5 : 0.05, angle = random.in_cube(1).x * 7;
    const Corners resting = triangle(size), moving = triangle(size);
    Vec3 axis = random.in_cube(1);
    axis = axis * (1 / length(axis));
    const double along = round % 2 == 0 ? 0 : random.in_cube(0.5).x;
    const Vec3 velocity = axis * along + (round % 5 == 0 ? random.in_cube(0.1) : Vec3{});
    const Vec3 center = random.in_cube(0.3);
    const double slid = dot(velocity, axis);
    const Orbits orbits{center,
                        axis,
                        length(velocity - axis * slid),
                        length(velocity),
                        std::min(slid, 0.0),
                        std::max(slid, 0.0),
                        round % 4 == 0 ? 0.0 : 0.02};
    const OrbitBounds of_resting = orbits.bounds(resting), of_moving = orbits.bounds(moving);
    if (!orbits.keep_apart(of_resting, of_moving)) continue;
    const auto by_one = [&](auto rule) {
      // Other bounds that say nothing.
      OrbitBounds r{{0, 9}, {-9, 9}, {0, 9}}, m = r;
      r.*rule = of_resting.*rule, m.*rule = of_moving.*rule;
      return orbits.keep_apart(r, m);
    };
    known[0] += by_one(&OrbitBounds::from_axis);
    known[1] += by_one(&OrbitBounds::along_axis);
    known[2] += by_one(&OrbitBounds::from_center);
    for (int n = 0; n <= 60; ++n) {
      const ClosestPair pair = closest_points(resting, moved(moving, orbits, velocity, angle, n / 60.0));
      ASSERT_GT(std::sqrt(pair.distance_sq), orbits.keep * (1 - 1e-12)) << round << " " << n;
    }
  }
  for (const int count : known) EXPECT_GT(count, 300);
}

}  // namespace
}  // namespace standoff::collision
