// SPDX-License-Identifier: Apache-2.0
// Points inside a closed body: by its fields, by rays, and by solid angles.
#include <gtest/gtest.h>

#include "collision/collide.h"
#include "tests/collision/solids.h"

namespace standoff {
namespace {

using namespace standoff::testing;
using namespace standoff::collision;

std::vector<Mesh> solids() {
  return {solid_ball(1, 6, {3, 4, 5}), solid_torus(1, 0.4, 24, 12),
          joined({solid_ball(1.2, 5), turned_inside_out(solid_ball(0.9, 5)), solid_ball(0.5, 4),
                  solid_ball(0.5, 4, {0.3, 0, 0}), solid_box({0.1, 2, 0.1}, {0.2, 0.3, 0.4}),
                  turned_inside_out(solid_ball(0.6, 4, {1.5, 0, 0}))})};
}

// Takes finer and finer fields; the finest has tiles that are not stored, inside and outside.
TEST(FieldSide, IsRightWhereItIsKnown) {
  for (const Mesh& mesh : solids())
    for (const double spacing : {0.3, 0.07, 0.02}) {
      const Body model(mesh, {.spacing = spacing, .execution = {.threads = 1}});
      const BodyData& data = data_of(model);
      Random random(1);
      int known = 0, inside = 0;
      constexpr int kPoints = 400;
      for (int n = 0; n < kPoints; ++n) {
        const Vec3 x = random.in_cube(data.radius);
        const Side side = side_of(data, x, 1e-6);
        if (side == Side::unknown) continue;
        ++known;
        inside += side == Side::inside;
        ASSERT_EQ(side == Side::inside, winding_by_angles(mesh, {}, x + data.middle) > 0.5) << spacing;
      }
      if (spacing == 0.02) {
        EXPECT_GT(known, kPoints * 9 / 10);
        EXPECT_GT(inside, kPoints / 50);
        EXPECT_GT(std::ranges::count(data.field.slots, 0), 0);
      }
    }
}

// Every sample of the fine field and the middle of every cell, with a wall at every distance from the tiles. If a tile
// that is not stored ends four spacings from the wall, the nearest coarse sample may lie beyond the tile, too near to
// the wall to decide.
TEST(FieldSide, OfEverySampleAndCell) {
  const double h = 0.06;
  for (int n = 0; n < 16; ++n) {
    const Vec3 half{0.9 + 0.25 * h * n, 0.95, 0.93};
    const Body model(solid_box(half), {.spacing = h, .execution = {.threads = 1}});
    const BodyData& data = data_of(model);
    const Grid grid = model.grid();
    for (const double shift : {0.0, 0.5 * h}) {
      std::int64_t unknown = 0, near = 0;
      for (std::int64_t k = 0; k < grid.size.z; ++k)
        for (std::int64_t j = 0; j < grid.size.y; ++j)
          for (std::int64_t i = 0; i < grid.size.x; ++i) {
            const Vec3 x = grid.position(i, j, k) + Vec3{shift, shift, shift};
            const double over = std::max({std::abs(x.x) - half.x, std::abs(x.y) - half.y, std::abs(x.z) - half.z});
            const Side side = side_of(data, x - data.middle, 1e-9);
            if (side == Side::unknown) {
              ++unknown;
            } else {
              ASSERT_EQ(side == Side::inside, over < 0) << n << " " << i;
            }
            near += std::abs(over) < h;
          }
      EXPECT_LT(unknown, near);
    }
  }
}

TEST(InsideTest, RaysAndFieldsAgreeAtAnyPose) {
  for (const Mesh& mesh : solids()) {
    const Body model(mesh, {.execution = {.threads = 1}});
    const double radius = data_of(model).radius;
    Random random(2);
    for (int n = 0; n < 30; ++n) {
      Pose pose = n == 0 ? Pose{} : random_pose(random, n % 3 == 0 ? 1e8 : 3);
      // Take a matrix as far from a rotation as poses may be.
      if (n % 2 == 1)
        for (double& entry : pose.rotation) entry += random.between(-2e-7, 2e-7);
      const PlacedBody placed(data_of(model), pose);
      const InsideTest test(placed);
      for (int k = 0; k < 20; ++k) {
        const Vec3 point = apply(pose, data_of(model).middle + random.in_cube(1.1 * radius));
        const bool inside = winding_by_angles(mesh, pose, point) > 0.5;
        ASSERT_EQ(test.is_inside_by_ray(point), inside) << n;
        ASSERT_EQ(test.is_inside(point), inside) << n;
      }
    }
  }
}

// The rays meet corners and edges, or run along faces.
TEST(InsideTest, RaysThroughCornersAndEdges) {
  const Mesh mesh = joined({solid_box({2, 2, 2}), solid_ball(1, 2, {0, 0, 0}), solid_box({1, 1, 1}, {1, 1, 1})});
  const Body model(mesh);
  const PlacedBody placed(data_of(model), {});
  const InsideTest test(placed);
  for (double x = -2.5; x <= 2.5; x += 0.25)
    for (double y = -2.5; y <= 2.5; y += 0.5)
      for (double z = -2.5; z <= 2.5; z += 0.5) {
        const bool on_wall = std::max({std::abs(x), std::abs(y), std::abs(z)}) == 2;
        if (on_wall) continue;
        const bool in_box = std::max({std::abs(x), std::abs(y), std::abs(z)}) < 2;
        EXPECT_EQ(test.is_inside_by_ray({x, y, z}), in_box) << x << " " << y << " " << z;
      }
}

// The matrix shrinks the body by 5e-7. Its transpose, in place of its inverse, moves points by more than that towards
// the middle, from outside to inside.
TEST(InsideTest, PosesThatAreNotQuiteRotations) {
  const Body model(solid_box({1.003, 0.1, 0.1}), {.spacing = 0.005});
  Pose pose;
  for (const int entry : {0, 4, 8}) pose.rotation[static_cast<std::size_t>(entry)] = 1 - 4.9e-7;
  validate(pose);
  const PlacedBody placed(data_of(model), pose);
  const InsideTest test(placed);
  const Grid grid = model.grid();
  for (std::int64_t j = 0; j < grid.size.y; ++j)
    for (std::int64_t k = 0; k < grid.size.z; ++k) {
      const Vec3 sample = grid.position(0, j, k);
      if (std::max(std::abs(sample.y), std::abs(sample.z)) > 0.099) continue;
      EXPECT_FALSE(test.is_inside({1.003 * (1 - 3e-7), sample.y, sample.z}));
      EXPECT_TRUE(test.is_inside({1.003 * (1 - 6e-7), sample.y, sample.z}));
    }
}

TEST(InsideTest, TellsBodiesApart) {
  const Body ball(solid_ball(1, 6)), far_ball(solid_ball(1, 6, {1e6, 0, 0}));
  const PlacedBody at_origin(data_of(ball), {});
  const InsideTest test(at_origin);
  EXPECT_TRUE(test.is_apart(PlacedBody(data_of(ball), moved({2.01, 0, 0}))));
  EXPECT_FALSE(test.is_apart(PlacedBody(data_of(ball), moved({1.99, 0, 0}))));
  EXPECT_FALSE(test.is_apart(PlacedBody(data_of(far_ball), moved({-1e6 + 1.99, 0, 0}))));
}

}  // namespace
}  // namespace standoff
