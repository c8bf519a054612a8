// SPDX-License-Identifier: Apache-2.0
// Many triangles far larger than the grid: thick bands skip most of them by their frames in float, thin bands measure
// all by their lines. Skipping must change no bit, so both give the same values.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/support/fields.h"
#include "tests/support/random_mesh.h"

namespace standoff {
namespace {

using testing::kInfinity;
using testing::Random;

constexpr Grid kLargeGrid{{20, 20, 20}, {-9.5, -9.5, -9.5}, {1, 1, 1}};

// Triangles of length `side`, `height` times as high as long, which all pass the grid's middle within 12 samples.
Mesh passing(unsigned seed, int count, double side, double height) {
  Random random(seed);
  Mesh mesh;
  for (int n = 0; n < count; ++n) {
    const Vec3 along = random.in_cube(side), middle = random.in_cube(12);
    const double share = random.between(0, 1);
    const Vec3 a = middle - along * share, b = middle + along * (1 - share);
    const Vec3 apex = a + along * random.between(0, 1) + random.in_cube(side * height);
    testing::add_triangle(mesh, a, b, apex);
  }
  return mesh;
}

void expect_same_bits(const Mesh& mesh, const std::string& name) {
  constexpr double kBand = 4;
  const DistanceField thin = testing::computed(mesh, kLargeGrid, kBand).field;
  const DistanceField full = testing::computed(mesh, kLargeGrid, kInfinity).field;
  std::int64_t different = 0, compared = 0;
  testing::for_each_sample(kLargeGrid, [&](auto i, auto j, auto k) {
    if (thin.nearest(i, j, k) == kNoTriangle) return;
    ++compared;
    different += thin.value(i, j, k) != full.value(i, j, k) || thin.nearest(i, j, k) != full.nearest(i, j, k);
  });
  EXPECT_EQ(different, 0) << name;
  EXPECT_GT(compared, 1000) << name;
}

TEST(LargeTriangles, WhatIsPassedOverChangesNoBit) {
  for (const double side : {20.0, 1e3, 1e5})
    for (const double height : {1.0, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-9, 0.0})
      expect_same_bits(passing(11, 1000, side, height),
                       "side " + std::to_string(side) + ", height " + std::to_string(height));
}

// Triangles so near to each other that their distances differ only by rounding.
TEST(LargeTriangles, SheafOfNearlyEqualOnes) {
  Random random(12);
  Mesh mesh;
  for (int n = 0; n < 3000; ++n) {
    const Vec3 off = random.in_cube(1e-5);
    testing::add_triangle(mesh, Vec3{-300, -200, 0.3} + off, Vec3{400, -200, 0.2} - off, Vec3{10, 500, -0.4} + off);
  }
  expect_same_bits(mesh, "sheaf");
}

}  // namespace
}  // namespace standoff
