// SPDX-License-Identifier: Apache-2.0
// What lies between the samples of a field.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <span>
#include <vector>

#include "field_samples.h"
#include "standoff/error.h"
#include "standoff/field.h"
#include "tests/support/error_code.h"
#include "tests/support/fields.h"

namespace standoff::testing {
namespace {

// A linear function has itself as its trilinear interpolation and its slope as the gradient.
constexpr Vec3 kSlope{2, -3, 0.5};
double linear(Vec3 p) { return 100 + dot(kSlope, p); }
DistanceField linear_field(const Grid& grid) {
  std::vector<float> values;
  for_each_sample(
      grid, [&](auto i, auto j, auto k) { values.push_back(static_cast<float>(linear(grid.position(i, j, k)))); });
  return DistanceField::from_dense(grid, kInfinity, values);
}

TEST(FieldInterpolation, InterpolatesLinearFunctionsExactly) {
  const auto field = linear_field(kGrid);
  std::mt19937 random(8);
  const Box box = kGrid.bounds();
  for (int n = 0; n < 500; ++n) {
    const auto share = [&] { return static_cast<double>(random() % 1001) / 1000; };
    const Vec3 p = box.min + box.extent() * Vec3{share(), share(), share()};
    EXPECT_NEAR(field.interpolate(p), linear(p), 1e-4);
    const Vec3 slope = field.gradient(p);
    EXPECT_LT(length(slope - kSlope), 1e-3) << slope.x << " " << slope.y << " " << slope.z;
  }
}

TEST(FieldInterpolation, InterpolationAtSamplesIsTheirValue) {
  const auto values = numbers(kGrid, 3);
  const auto field = DistanceField::from_dense(kGrid, 3.5, values);
  for_each_sample(kGrid, [&](auto i, auto j, auto k) {
    ASSERT_EQ(field.interpolate(kGrid.position(i, j, k)), values[kGrid.index(i, j, k)]) << i << " " << j << " " << k;
  });
}

// Around a ball of radius 1 in a box of half-width 1.5: below the distance everywhere outside, near it, and continuous.
TEST(FieldInterpolation, BoundsTheDistanceOutsideTheGrid) {
  const Grid grid{{25, 25, 25}, {-1.5, -1.5, -1.5}, {0.125, 0.125, 0.125}};
  std::vector<float> values;
  for_each_sample(
      grid, [&](auto i, auto j, auto k) { values.push_back(static_cast<float>(length(grid.position(i, j, k)) - 1)); });
  const auto field = DistanceField::from_dense(grid, kInfinity, values);
  std::mt19937 random(4);
  const auto anywhere = [&] {
    return std::ldexp(static_cast<double>(random() % 2001) - 1000, static_cast<int>(random() % 5) - 9);
  };
  int outside = 0;
  for (int n = 0; n < 3000; ++n) {
    const Vec3 p{anywhere(), anywhere(), anywhere()};
    if (max_norm(p) <= 1.5) EXPECT_EQ(field.interpolate(p, Outside::bound), field.interpolate(p)) << n;
    if (max_norm(p) <= 1.51) continue;
    ++outside;
    const double bound = field.interpolate(p, Outside::bound), distance = length(p) - 1;
    EXPECT_LE(bound, distance) << p.x << " " << p.y << " " << p.z;
    EXPECT_GE(bound, 0.6 * distance - 0.11) << p.x << " " << p.y << " " << p.z;
    EXPECT_LE(field.interpolate(p, Outside::border) - 0.11, bound);
    const Vec3 slope = field.gradient(p, Outside::bound);
    for (const Vec3 axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) {
      constexpr double kStep = 1e-6;
      const double ahead = field.interpolate(p + axis * kStep, Outside::bound),
                   behind = field.interpolate(p - axis * kStep, Outside::bound);
      // Not where a step passes from one cell to the next.
      if (std::abs((ahead - bound) - (bound - behind)) > 1e-9) continue;
      EXPECT_NEAR((ahead - behind) / (2 * kStep), dot(slope, axis), 1e-3) << p.x << " " << p.y << " " << p.z;
    }
  }
  EXPECT_GT(outside, 1000);
}

// Within a cell by definition: the eight corners, each with the volume opposite to it.
TEST(FieldInterpolation, InterpolatesBetweenTheCorners) {
  const Grid grid{{2, 2, 2}, {1, 2, 3}, {2, 4, 8}};
  const std::vector<float> values{0, 1, 2, 4, 8, 16, 32, 64};
  const auto field = DistanceField::from_dense(grid, kInfinity, values);
  for (const Vec3 t : {Vec3{0.5, 0.5, 0.5}, Vec3{0.25, 0.5, 0.125}, Vec3{1, 0, 0.75}}) {
    double expected = 0;
    for (int c = 0; c < 8; ++c)
      expected += values[c] * (c & 1 ? t.x : 1 - t.x) * (c & 2 ? t.y : 1 - t.y) * (c & 4 ? t.z : 1 - t.z);
    const Vec3 p = grid.origin + grid.spacing * t;
    EXPECT_NEAR(field.interpolate(p), expected, 1e-12);
    // The derivative of a trilinear function along an axis is its difference over any step within the cell.
    const Vec3 slope = field.gradient(p);
    const auto difference = [&](Vec3 d) {
      return (field.interpolate(p + d) - field.interpolate(p - d)) / (2 * length(d));
    };
    if (t.x > 0 && t.x < 1) {
      EXPECT_NEAR(slope.x, difference({0.1, 0, 0}), 1e-9);
    }
    if (t.y > 0 && t.y < 1) {
      EXPECT_NEAR(slope.y, difference({0, 0.1, 0}), 1e-9);
    }
    EXPECT_NEAR(slope.z, difference({0, 0, 0.1}), 1e-9);
  }
}

// Outside it knows nothing. It answered with the border's value, which is wrong by any amount.
TEST(FieldInterpolation, OutsideTheGridNothingIsKnown) {
  const auto field = linear_field(kGrid);
  const Box box = kGrid.bounds();
  const Vec3 h = kGrid.spacing, middle = (box.min + box.max) * 0.5;
  const auto expect_known = [&](Vec3 p, bool known) {
    EXPECT_EQ(std::isnan(field.interpolate(p)), !known) << p.x << " " << p.y << " " << p.z;
    const Vec3 slope = field.gradient(p);
    for (const double s : {slope.x, slope.y, slope.z}) EXPECT_EQ(std::isnan(s), !known);
    std::vector<double> values(1);
    field.interpolate(std::span(&p, 1), values);
    EXPECT_EQ(std::isnan(values[0]), !known);
    if (known) EXPECT_EQ(field.interpolate(p), field.interpolate(p, Outside::border));
  };
  for (const Vec3 axis : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}}) {
    const Vec3 low = middle + (box.min - middle) * axis, high = middle + (box.max - middle) * axis;
    expect_known(low, true);
    expect_known(high, true);
    expect_known(low - axis * h * 9e-4, true);  // rounded coordinates of the border
    expect_known(high + axis * h * 9e-4, true);
    expect_known(low - axis * h * 2e-3, false);
    expect_known(high + axis * h * 2e-3, false);
    expect_known(high + axis * 1e300, false);
  }
  expect_known({kInfinity, 0, 0}, false);
}

TEST(FieldInterpolation, AskedForTheBorderTheNearestPointOfTheGridCounts) {
  const auto field = linear_field(kGrid);
  const Box box = kGrid.bounds();
  for (const Vec3 p : {box.min - Vec3{1, 2, 3}, box.max + Vec3{1e9, 0, 0}, Vec3{box.min.x, box.max.y + 5, 31.5},
                       Vec3{kInfinity, -kInfinity, 31}}) {
    const Vec3 inside = max(box.min, min(box.max, p));
    EXPECT_EQ(field.interpolate(p, Outside::border), field.interpolate(inside));
    EXPECT_EQ(field.gradient(p, Outside::border), field.gradient(inside));
  }
  EXPECT_EQ(code_of([&] { field.interpolate({0, std::nan(""), 0}); }), ErrorCode::usage);
  EXPECT_EQ(code_of([&] { field.gradient({0, 0, std::nan("")}); }), ErrorCode::usage);
}

TEST(FieldInterpolation, AxesOfOneSample) {
  const auto field = linear_field({{5, 1, 1}, {0, 7, 8}, {1, 1, 1}});
  EXPECT_NEAR(field.interpolate({2.25, 7, 8}), linear({2.25, 7, 8}), 1e-4);
  EXPECT_NEAR(field.interpolate({2.25, -100, 100}, Outside::border), linear({2.25, 7, 8}), 1e-4);
  EXPECT_TRUE(std::isnan(field.interpolate({2.25, 7, 8.1}))) << "beside its plane";
  EXPECT_EQ(field.gradient({2.25, 7, 8}), (Vec3{kSlope.x, 0, 0}));
  const auto point = linear_field({{1, 1, 1}, {0, 7, 8}, {1, 1, 1}});
  EXPECT_EQ(point.interpolate({3, 3, 3}, Outside::border), static_cast<float>(linear({0, 7, 8})));
  EXPECT_EQ(point.gradient({0, 7, 8}), Vec3{});
}

TEST(FieldInterpolation, ManyPointsGetWhatEachGetsAlone) {
  const auto field = DistanceField::from_dense(kGrid, 2, numbers(kGrid, 3));
  const Box box = kGrid.bounds();
  std::mt19937 random(8);
  std::vector<Vec3> points;
  for (int n = 0; n < 5000; ++n) {
    const auto share = [&] { return static_cast<double>(random() % 1201) / 1000 - 0.1; };
    points.push_back(box.min + box.extent() * Vec3{share(), share(), share()});
  }
  for (const int threads : {1, 3}) {
    std::vector<double> values(points.size(), -1);
    std::vector<Vec3> slopes(points.size());
    field.interpolate(points, values, {.threads = threads}, Outside::border);
    field.gradient(points, slopes, {.threads = threads}, Outside::border);
    for (std::size_t n = 0; n < points.size(); ++n) {
      ASSERT_EQ(values[n], field.interpolate(points[n], Outside::border)) << n;
      ASSERT_EQ(slopes[n], field.gradient(points[n], Outside::border)) << n;
    }
  }
  std::vector<double> few(3);
  EXPECT_EQ(code_of([&] { field.interpolate(points, few); }), ErrorCode::usage);
  std::vector<double> values(points.size());
  EXPECT_EQ(code_of([&] { field.interpolate(points, values, {.threads = -1}); }), ErrorCode::usage);
  EXPECT_EQ(code_of([&] { field.interpolate(points, values, {.backend = Backend::cuda}); }), ErrorCode::usage);
  points[4321].y = std::nan("");
  EXPECT_EQ(code_of([&] { field.interpolate(points, values); }), ErrorCode::usage);
  EXPECT_NO_THROW(field.interpolate(std::span<const Vec3>(), std::span<double>()));
}

// Infinity less infinity would be no number.
TEST(FieldInterpolation, InfiniteValuesGiveInfinityNeverNaN) {
  const float infinite = std::numeric_limits<float>::infinity();
  const Grid grid{{2, 2, 2}, {}, {1, 1, 1}};
  const auto none = DistanceField::from_dense(grid, kInfinity, std::vector<float>(8, infinite));
  EXPECT_EQ(none.interpolate({0.5, 0.5, 0.5}), kInfinity);
  EXPECT_EQ(none.gradient({0.5, 0.5, 0.5}), Vec3{});
  const auto half = DistanceField::from_dense(grid, kInfinity,
                                              std::vector<float>{1, infinite, 1, infinite, 1, infinite, 1, infinite});
  EXPECT_EQ(half.interpolate({0, 0.5, 0.5}), 1);  // no share of the infinite corners
  EXPECT_EQ(half.interpolate({0.5, 0.5, 0.5}), kInfinity);
  for (const double t : {0.0, 0.25, 1.0}) {
    EXPECT_FALSE(std::isnan(half.interpolate({t, 0.5, 0.5}))) << t;
    const Vec3 slope = half.gradient({t, 0.5, 0.5});
    EXPECT_FALSE(std::isnan(slope.x + slope.y + slope.z)) << t;
  }
}

}  // namespace
}  // namespace standoff::testing
