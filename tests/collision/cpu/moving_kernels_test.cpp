// SPDX-License-Identifier: Apache-2.0
// The kernels of sweeps: boxes and triangles stay apart as long as the kernels say, and boxes that move along a surface
// for a long time.
#include <gtest/gtest.h>

#include <bit>
#include <cstring>

#include "collision/cpu/kernels.h"
#include "tests/collision/bodies.h"

namespace standoff {
namespace {

using namespace standoff::testing;
using namespace collision;

constexpr double kKeep = 1e-3;

DoubleObb random_box(Random& random, double half, double size) {
  const Pose pose = random_pose(random, half);
  DoubleObb box{pose.translation, {}, {}};
  for (int k = 0; k < 3; ++k) {
    box.axis[k] = {pose.rotation[k], pose.rotation[3 + k], pose.rotation[6 + k]};
    box.half[k] = size * random.between(0, 1) * random.between(0, 1);
  }
  return box;
}

RigidVelocity random_velocity(Random& random) {
  RigidVelocity velocity{random.in_cube(random.between(0, 1) < 0.5 ? 0.1 : 2),
                         random.in_cube(random.between(0, 1) < 0.3 ? 0 : 3), random.in_cube(2), 0};
  velocity.rate = std::max(length(velocity.rotation), 1e-300);
  return velocity;
}

// Where a point is after a time.
Vec3 later(const RigidVelocity& velocity, const Vec3& point, double time) {
  const Vec3 arm = point - velocity.center, center = velocity.center + velocity.linear * time;
  if (length(velocity.rotation) == 0) return center + arm;
  return center + rotate(make_pose(velocity.rotation, velocity.rate * time, {}), arm);
}
DoubleObb later(const RigidVelocity& velocity, DoubleObb box, double time) {
  for (Vec3& axis : box.axis) axis = later(velocity, box.center + axis, time) - later(velocity, box.center, time);
  box.center = later(velocity, box.center, time);
  return box;
}

Mesh mesh_of(const DoubleObb& box) {
  Mesh mesh;
  const auto corner = [&](int n) {
    Vec3 at = box.center;
    for (int k = 0; k < 3; ++k) at = at + box.axis[k] * (n >> k & 1 ? box.half[k] : -box.half[k]);
    return at;
  };
  for (int k = 0; k < 3; ++k)
    for (int side = 0; side < 2; ++side) {
      const int u = 1 << (k + 1) % 3, v = 1 << (k + 2) % 3, first = side << k;
      add_triangle(mesh, corner(first), corner(first + u), corner(first + v));
      add_triangle(mesh, corner(first + u), corner(first + v), corner(first + u + v));
    }
  return mesh;
}

// In single precision, as bodies have them.
DoubleObb rounded(DoubleObb box) {
  const auto round = [](double x) { return double{static_cast<float>(x)}; };
  for (Vec3* v : {&box.center, &box.axis[0], &box.axis[1], &box.axis[2]}) *v = {round(v->x), round(v->y), round(v->z)};
  for (double& half : box.half) half = round(half);
  return box;
}
void put(const DoubleObb& box, Obb16& sixteen, int lane) {
  Obb one;
  for (int j = 0; j < 3; ++j) {
    const auto axis = static_cast<std::size_t>(j);
    one.center[j] = static_cast<float>(box.center[axis]), one.half[j] = static_cast<float>(box.half[j]);
    for (int k = 0; k < 3; ++k) one.axis[k][j] = static_cast<float>(box.axis[k][axis]);
  }
  sixteen.set(lane, one);
}

TEST(MovingBoxes, StayApartAsLongAsTheKernelsSay) {
  Random random(1);
  double longest = 0;
  for (int round = 0; round < 60; ++round) {
    Obb16 sixteen;
    DoubleObb boxes[kLanes];
    for (int n = 0; n < kLanes; ++n) put(boxes[n] = rounded(random_box(random, 2, 0.7)), sixteen, n);
    const DoubleObb box = rounded(random_box(random, 1, 0.7));
    const RigidVelocity velocity = random_velocity(random);
    const bool sixteen_move = round % 2;
    double times[kLanes], early[kLanes], of_portable[kLanes];
    best_kernels().obb_free_times(sixteen, box, sixteen_move, velocity, kKeep, kInfinity, times);
    best_kernels().obb_free_times(sixteen, box, sixteen_move, velocity, kKeep, 0.1, early);
    Kernels::portable.obb_free_times(sixteen, box, sixteen_move, velocity, kKeep, kInfinity, of_portable);
    EXPECT_EQ(std::memcmp(times, of_portable, sizeof times), 0);
    for (int n = 0; n < kLanes; ++n) {
      const DoubleObb &resting = sixteen_move ? box : boxes[n], &moving = sixteen_move ? boxes[n] : box;
      EXPECT_EQ(times[n], best_kernels().obb_free_time(resting, moving, velocity, kKeep));
      EXPECT_LE(early[n], times[n]);
      EXPECT_GE(early[n], std::min(times[n], 0.1));
      const double until = std::min(times[n], 3.0);
      longest = std::max(longest, until);
      if (until == 0) continue;
      for (const double share : {0.3, 0.7, 0.9, 1.0})
        ASSERT_GE(brute_pair_distance(mesh_of(resting), {}, mesh_of(later(velocity, moving, share * until)), {}),
                  kKeep * (1 - 1e-6))
            << "round " << round << ", lane " << n << ", at " << share << " of " << until;
    }
  }
  EXPECT_EQ(longest, 3);
}

// By its speed alone the box would advance by a hundredth of this.
TEST(MovingBoxes, ThatMoveAlongASurfaceAdvanceByTheRootOfTheGap) {
  const Vec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
  const DoubleObb plate{{0, 0, 0}, {x, y, z}, {5, 5, 0}};
  for (const double gap : {1e-2, 1e-4, 1e-6}) {
    const DoubleObb point{{0, 0, gap}, {x, y, z}, {0, 0, 0}};
    const RigidVelocity circling{{0, 0, 0}, {1, 0, 0}, {0, 0, gap - 1}, 1};
    const double time = best_kernels().obb_free_time(plate, point, circling, 0);
    EXPECT_LE(time, std::acos(1 - gap));
    EXPECT_GE(time, 0.999 * std::sqrt(2 * gap));
    const RigidVelocity sliding{{3, 2, 0}, {}, {}, 1e-300};
    EXPECT_GT(best_kernels().obb_free_time(plate, point, sliding, gap / 2), 1);
  }
}

// The part of the approach that comes from the box's size: its center does not move.
TEST(MovingBoxes, TurnTheirCornersIntoWhatTheyPass) {
  const Vec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
  const DoubleObb wall{{0, 0, -0.5}, {x, y, z}, {5, 5, 0}}, rod{{0, 0, 0}, {x, y, z}, {1, 0, 0}};
  for (const double rate : {0.5, -2.0}) {
    const RigidVelocity turning{{}, {0, rate, 0}, {}, std::abs(rate)};
    const double time = best_kernels().obb_free_time(wall, rod, turning, 0);
    EXPECT_LE(time, std::asin(0.5) / std::abs(rate));
    EXPECT_GE(time, 0.8 * std::asin(0.5) / std::abs(rate));
  }
}

TEST(MovingTriangles, ThatAreExcludedDoNotMeet) {
  Random random(2);
  int excluded = 0;
  for (int round = 0; round < 40; ++round) {
    DoubleTriangles resting, moving;
    Corners of_resting[kLanes], of_moving[kLanes];
    const Pose pose = random_pose(random, 0.5);
    for (int n = 0; n < kLanes; ++n) {
      const Vec3 at = random.in_cube(1), from = random.in_cube(1);
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 p = of_resting[n][k] = at + random.in_cube(0.4), q = from + random.in_cube(0.4);
        of_moving[n][k] = apply(pose, q);
        for (std::size_t j = 0; j < 3; ++j) resting.corner[k][j][n] = p[j], moving.corner[k][j][n] = q[j];
      }
    }
    DoubleTransform to_resting;
    for (int n = 0; n < 9; ++n) to_resting.rotation[n] = pose.rotation[static_cast<std::size_t>(n)];
    for (std::size_t j = 0; j < 3; ++j) to_resting.translation[j] = pose.translation[j];
    Vec3 axes[kLeafAxes];
    for (Vec3& axis : axes) axis = random.in_cube(1), axis = axis * (1 / length(axis));
    const RigidVelocity velocity = random_velocity(random);
    constexpr double kDuration = 0.3;
    std::uint32_t lanes[kLanes], of_portable[kLanes];
    best_kernels().approaching_triangles(resting, moving, to_resting, velocity, axes, kKeep, kDuration, lanes);
    Kernels::portable.approaching_triangles(resting, moving, to_resting, velocity, axes, kKeep, kDuration, of_portable);
    EXPECT_EQ(std::memcmp(lanes, of_portable, sizeof lanes), 0);
    for (int n = 0; n < kLanes; ++n)
      for (int m = 0; m < kLanes; ++m) {
        if (lanes[n] >> m & 1) continue;
        ++excluded;
        for (int step = 0; step <= 8; ++step) {
          Corners there;
          for (std::size_t k = 0; k < 3; ++k) there[k] = later(velocity, of_moving[m][k], kDuration * step / 8);
          ASSERT_FALSE(triangles_intersect(of_resting[n], there)) << round << ": " << n << ", " << m;
          ASSERT_GE(std::sqrt(closest_points(of_resting[n], there).distance_sq), kKeep * (1 - 1e-6));
        }
      }
  }
  EXPECT_GT(excluded, 40 * kLanes * kLanes / 4);
}

}  // namespace
}  // namespace standoff
