// SPDX-License-Identifier: Apache-2.0
// Shells: of a point and a segment they are balls and capsules, whose distances are known in closed form; of any mesh
// they are the unsigned field less half of the shell's thickness.
#include <gtest/gtest.h>

#include <cmath>

#include "sign/shell.h"
#include "standoff/compute.h"
#include "tests/support/expect_error.h"
#include "tests/support/fields.h"
#include "tests/support/random_mesh.h"

namespace standoff {
namespace {

ComputeOptions shell_of(double thickness, bool nearest = false, bool invert = false) {
  ComputeOptions options;
  options.sign.method = SignMethod::shell;
  options.sign.shell = thickness;
  options.sign.invert = invert;
  options.nearest_triangle = nearest;
  return options;
}

// The largest error in terms of the one promised of the distance.
template <class Distance>
double worst_error(const DistanceField& field, double shell, const Distance& distance) {
  double worst = 0;
  testing::for_each_sample(field.grid(), [&](auto i, auto j, auto k) {
    const double d = distance(field.grid().position(i, j, k));
    const double expected = std::clamp(d - shell / 2, -field.thickness(), field.thickness());
    worst = std::max(worst, std::abs(field.value(i, j, k) - expected) / testing::promised_error(field.grid(), d));
  });
  return worst;
}

const Grid kShellGrid{{35, 34, 41}, {-1.71, -1.62, -2.03}, {0.1, 0.1, 0.1}};

TEST(Shell, OfAPointIsABallOfASegmentACapsule) {
  const Mesh point{{{0.013, 0.02, -0.04}}, {{0, 0, 0}}};
  const Mesh segment{{{0, 0, -0.8}, {0, 0, 0.7}}, {{0, 1, 1}}};
  for (const double shell : {0.02, 0.5, 2.3})
    for (const double thickness : {0.15, 0.4, kFullField}) {
      const DistanceField ball = compute(point, kShellGrid, thickness, shell_of(shell)).field;
      EXPECT_LE(worst_error(ball, shell, [&](Vec3 p) { return length(p - point.vertices[0]); }), 1);
      const DistanceField capsule = compute(segment, kShellGrid, thickness, shell_of(shell)).field;
      EXPECT_LE(worst_error(capsule, shell,
                            [&](Vec3 p) {
                              return std::hypot(p.x, p.y, std::max({0.0, p.z - 0.7, -0.8 - p.z}));
                            }),
                1);
      EXPECT_EQ(capsule.provenance().sign.substr(0, 5), "shell");
      EXPECT_EQ(capsule.thickness(), thickness);
    }
  EXPECT_LT(compute(point, kShellGrid, 0.2, shell_of(1)).field.value(17, 16, 20), 0);
}

TEST(Shell, OfAPlane) {
  Mesh plane;
  testing::add_triangle(plane, {-50, -50, 0.013}, {50, -50, 0.013}, {0, 80, 0.013});
  for (const double shell : {0.01, 0.7}) {
    const DistanceField field = compute(plane, kShellGrid, 0.31, shell_of(shell)).field;
    EXPECT_LE(worst_error(field, shell, [](Vec3 p) { return std::abs(p.z - 0.013); }), 1);
  }
}

// Of the full unsigned field each value has one more rounding.
TEST(Shell, IsTheDistanceLessHalfInSparseAndDenseFields) {
  const Mesh mesh = testing::random_soup(4, 60, 1.2, 0.7);
  const std::vector<float> distances = compute(mesh, kShellGrid, kFullField).field.to_dense();
  for (const double shell : {0.05, 0.37, 2.9})
    for (const double thickness : {0.12, 0.5, kFullField})
      for (const bool invert : {false, true}) {
        const ComputeOptions options = shell_of(shell, true, invert);
        const DistanceField field = compute(mesh, kShellGrid, thickness, options).field;
        std::vector<float> dense(distances.size());
        std::vector<std::uint32_t> nearest(distances.size());
        compute_into(mesh, kShellGrid, thickness, dense, nearest, options);
        const DistanceField from_dense = DistanceField::from_dense(kShellGrid, thickness, dense, nearest);
        testing::expect_same_bits(field, from_dense);
        EXPECT_EQ(field.stored_tiles(), from_dense.stored_tiles());
        std::int64_t wrong = 0, nearest_wrong = 0;
        for (std::size_t n = 0; n < dense.size(); ++n) {
          const double value = (invert ? -1 : 1) * (distances[n] - shell / 2);
          wrong += dense[n] != static_cast<float>(std::clamp(value, -thickness, thickness));
          nearest_wrong += (nearest[n] == kNoTriangle) != (std::abs(value) > thickness);
        }
        EXPECT_EQ(wrong, 0);
        EXPECT_EQ(nearest_wrong, 0);
        const auto last = field.tile(4, 4, 5);
        EXPECT_TRUE(!last || (*last)[511] == static_cast<float>(thickness));  // beyond the grid
      }
}

TEST(Shell, TilesDeepInsideAreNotStored) {
  const Mesh point{{{0, 0, 0}}, {{0, 0, 0}}};
  const Grid grid{{80, 80, 80}, {-40, -40, -40}};
  const DistanceField field = compute(point, grid, 2, shell_of(60)).field;
  EXPECT_EQ(field.background(5, 5, 5), -2);
  EXPECT_FALSE(field.tile(5, 5, 5));
  EXPECT_EQ(field.background(0, 0, 0), 2);
  EXPECT_FALSE(field.tile(0, 0, 0));
  EXPECT_TRUE(field.tile(1, 5, 5));
  EXPECT_GT(field.stored_tiles(), 100);
}

TEST(Shell, MemoryIsThatOfTheDistancesItNeeds) {
  const Mesh mesh = testing::random_soup(4, 60, 1.2, 0.1);
  EXPECT_EQ(memory_needed(mesh, kShellGrid, 0.25, shell_of(0.5)), memory_needed(mesh, kShellGrid, 0.5));
  ComputeOptions limited = shell_of(0.5);
  limited.memory_limit = memory_needed(mesh, kShellGrid, 0.5) - 1;
  expect_error([&] { compute(mesh, kShellGrid, 0.25, limited); }, ErrorCode::limit, "the field may need");
}

TEST(Shell, ThicknessesThatAreNone) {
  const Mesh mesh = testing::random_soup(4, 6, 1, 1);
  for (const double shell : {0.0, -1.0, std::nan(""), kFullField})
    expect_error([&] { compute(mesh, kShellGrid, 1, shell_of(shell)); }, ErrorCode::usage, "positive and finite");
  expect_error([&] { compute(mesh, kShellGrid, 1, shell_of(1e6)); }, ErrorCode::limit, "coarser than the grid");
  ComputeOptions options;
  options.sign.shell = 1;
  expect_error([&] { compute(mesh, kShellGrid, 1, options); }, ErrorCode::usage, "for the sign method shell");
}

}  // namespace
}  // namespace standoff
