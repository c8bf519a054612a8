// SPDX-License-Identifier: Apache-2.0
// Bounds that queries rely on, similar bounds that do not hold, and the kernels that compute them.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <span>

#include "collision/body/body.h"
#include "collision/cpu/kernels.h"
#include "geometry/predicates.h"
#include "standoff/compute.h"
#include "tests/collision/bodies.h"
#include "tests/support/reference.h"

namespace standoff {
namespace {

using namespace standoff::testing;
using namespace standoff::collision;

// Points around a body: near its surface, in its field's grid and outside.
std::vector<Vec3> points_around(const Body& model, int count, unsigned seed) {
  Random random(seed);
  std::vector<Vec3> points;
  const double half = data_of(model).radius;
  for (int n = 0; n < count; ++n) points.push_back(random.in_cube(half * (n % 3 == 0 ? 4 : 1.1)));
  return points;
}

TEST(Bounds, GapsNeverExceedTheDistance) {
  for (const Mesh& mesh : {ball_mesh(1, 5, {7, 8, 9}), random_soup(3, 200, 1, 0.3), nasty_soup(2, 60, 3)}) {
    const Body model(mesh, {.spacing = 0.07});
    const auto& data = data_of(model);
    const std::vector<Vec3> points = points_around(model, 3200, 1);
    double worst = -1, tightest = 0;
    int counted = 0;
    for (std::size_t first = 0; first < points.size(); first += kLanes) {
      alignas(64) float center[3][kLanes], radius[kLanes], gap[kLanes];
      for (int n = 0; n < kLanes; ++n) {
        const Vec3 p = points[first + n];
        center[0][n] = float(p.x), center[1][n] = float(p.y), center[2][n] = float(p.z);
        radius[n] = n % 2 ? 0.0f : 0.05f;
      }
      best_kernels().gaps_at(data.view, center, radius, 1e30f, gap);
      for (int n = 0; n < kLanes; ++n) {
        const Vec3 p = Vec3{center[0][n], center[1][n], center[2][n]} + data.middle;
        const double true_gap = reference_distance(mesh, p) - radius[n];
        worst = std::max(worst, gap[n] - true_gap);
        if (true_gap > 0.5 * model.thickness()) continue;
        tightest += true_gap - gap[n];
        ++counted;
      }
    }
    EXPECT_LE(worst, 2e-6 * 20) << "a bound above the distance";
    EXPECT_LE(tightest / counted, model.grid().spacing.x) << "bounds are good for nothing";
  }
}

TEST(Bounds, KernelsAgreeBitForBit) {
  const Body model(random_soup(3, 200, 1, 0.3));
  const auto& data = data_of(model);
  const std::span<const Kernels* const> rows = all_kernels();
  const std::span<const Boxes16> boxes = data.bvh.tree.level(0);
  const HugePageVector<Sphere16>& spheres = data.bvh.spheres[0];
  FloatTransform place{{0.6f, -0.8f, 0, 0.8f, 0.6f, 0, 0, 0, 1}, {0.1f, 0.2f, -0.3f}};
  FloatBox box;
  for (const float* p : {boxes[0].low[0], boxes[0].high[0]}) {
    const float at[3] = {p[0], p[1], p[2]};
    box.include(at);
  }
  for (std::size_t k = 1; k < rows.size(); ++k)
    for (std::size_t packet = 0; packet < spheres.size(); ++packet) {
      alignas(64) float a[kLanes], b[kLanes];
      rows[0]->gaps(data.view, place, spheres[packet], 0.1f, a);
      rows[k]->gaps(data.view, place, spheres[packet], 0.1f, b);
      EXPECT_EQ(std::memcmp(a, b, sizeof a), 0) << rows[0]->name << " and " << rows[k]->name;
      EXPECT_EQ(rows[0]->overlapping(boxes[packet], box), rows[k]->overlapping(boxes[packet], box));
    }
}

// The samples around a point give max(s - |x - x_i|) <= d(x) <= min(s + |x - x_i|), and the error of the trilinear
// interpolation is at most sqrt(3)/2 spacings.
TEST(Bounds, SamplesBoundTheDistanceBetweenThem) {
  const Mesh mesh = random_soup(5, 100, 1, 0.4);
  const double h = 0.1;
  const Grid grid = fit_spacing(bounds(mesh), {h, h, h}, {.length = 0.3, .least_samples = 0});
  const DistanceField field = compute(mesh, grid, kFullField, {.sign = {SignMethod::none}}).field;
  Random random(1);
  double worst_trilinear = 0;
  for (int n = 0; n < 3000; ++n) {
    const Vec3 u{random.between(0, double(grid.size.x - 1)), random.between(0, double(grid.size.y - 1)),
                 random.between(0, double(grid.size.z - 1))};
    const Vec3 x = grid.origin + grid.spacing * u;
    const double d = reference_distance(mesh, x);
    double lower = 0, upper = 1e30;
    for (int corner = 0; corner < 8; ++corner) {
      const auto i = std::min<std::int64_t>(std::int64_t(u.x) + (corner & 1), grid.size.x - 1),
                 j = std::min<std::int64_t>(std::int64_t(u.y) + (corner >> 1 & 1), grid.size.y - 1),
                 k = std::min<std::int64_t>(std::int64_t(u.z) + (corner >> 2), grid.size.z - 1);
      const double s = field.value(i, j, k), off = length(x - grid.position(i, j, k));
      lower = std::max(lower, s - off), upper = std::min(upper, s + off);
    }
    ASSERT_LE(lower, d + 1e-5);
    ASSERT_GE(upper, d - 1e-5);
    worst_trilinear = std::max(worst_trilinear, std::abs(field.interpolate(x) - d) / h);
  }
  EXPECT_LE(worst_trilinear, std::sqrt(3) / 2 + 1e-4);
  EXPECT_GT(worst_trilinear, 0.3) << "the test met no hard place";
}

// Outside a band of half-width w, d >= w + (distance to the nearest stored sample) - sqrt(3) h. With sqrt(3)/2 it is
// wrong, as a triangle in the middle of a cell shows from the cell's diagonal.
TEST(Bounds, BeyondABandHalfTheDiagonalIsNotEnough) {
  const double h = 1, w = 2;
  const Mesh point = one_triangle({0.5, 0.5, 0.5}, {0.5, 0.5, 0.5}, {0.5, 0.5, 0.5});
  const Grid grid{{25, 25, 25}, {-12, -12, -12}, {h, h, h}};
  ComputeOptions options{.sign = {SignMethod::none}};
  const DistanceField field = compute(point, grid, w, options).field;
  std::vector<Vec3> band;
  for (std::int64_t k = 0; k < 25; ++k)
    for (std::int64_t j = 0; j < 25; ++j)
      for (std::int64_t i = 0; i < 25; ++i)
        if (field.value(i, j, k) < w) band.push_back(grid.position(i, j, k));
  Random random(2);
  double half_fails_by = 0;
  for (int n = 0; n < 20000; ++n) {
    const Vec3 x = random.in_cube(11);
    const double d = reference_distance(point, x);
    if (d < w) continue;
    double to_band = 1e30;
    for (const Vec3& p : band) to_band = std::min(to_band, length(x - p));
    ASSERT_GE(d, w + to_band - std::sqrt(3) * h - 1e-9);
    half_fails_by = std::max(half_fails_by, w + to_band - std::sqrt(3) / 2 * h - d);
  }
  EXPECT_GT(half_fails_by, 0) << "the false bound was never wrong: the test proves nothing";
}

// The nearest triangle of the nearest sample bounds the distance from above, and is often not the nearest one.
TEST(Bounds, AStoredNearestTriangleIsAnUpperBoundOnly) {
  const Mesh mesh = random_soup(6, 200, 1, 0.2);
  const double h = 0.15;
  const Grid grid = fit_spacing(bounds(mesh), {h, h, h}, {.length = 0.3, .least_samples = 0});
  ComputeOptions options{.sign = {SignMethod::none}};
  options.nearest = true;
  const DistanceField field = compute(mesh, grid, kFullField, options).field;
  Random random(3);
  int wrong = 0;
  for (int n = 0; n < 2000; ++n) {
    const Vec3 u{random.between(0, double(grid.size.x - 1)), random.between(0, double(grid.size.y - 1)),
                 random.between(0, double(grid.size.z - 1))};
    const Vec3 x = grid.origin + grid.spacing * u;
    const double d = reference_distance(mesh, x),
                 to_stored =
                     reference_distance(mesh, field.nearest(std::lround(u.x), std::lround(u.y), std::lround(u.z)), x);
    ASSERT_GE(to_stored, d - 1e-9);
    wrong += to_stored > d + 1e-6;
  }
  EXPECT_GT(wrong, 20);
}

TEST(Predicates, SignsOfNearlyFlatTetrahedra) {
  const Vec3 a{0.1, 0.1, 0.1}, b{12.7, 0.3, 0.2}, c{0.4, 9.1, 0.3};
  Random random(4);
  int zeros = 0;
  for (int n = 0; n < 20000; ++n) {
    // A point on the plane up to rounding, where plain double arithmetic gets signs wrong.
    const double s = random.between(-2, 2), t = random.between(-2, 2);
    const Vec3 d = a + (b - a) * s + (c - a) * t;
    const int sign = orient3d(a, b, c, d);
    // All even permutations give the sign, all odd ones the opposite: this holds for the exact sign only.
    ASSERT_EQ(orient3d(b, c, a, d), sign);
    ASSERT_EQ(orient3d(c, a, b, d), sign);
    ASSERT_EQ(orient3d(b, a, c, d), -sign);
    ASSERT_EQ(orient3d(a, b, d, c), -sign);
    ASSERT_EQ(orient3d(d, c, b, a), sign);
    zeros += sign == 0;
  }
  EXPECT_LT(zeros, 20000);
  EXPECT_EQ(orient3d({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.3, 0.7, 0}), 0);
  EXPECT_EQ(orient3d({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.3, 0.7, 1e-80}), 1);
  EXPECT_EQ(orient2d({0, 0}, {0.1, 0.1}, {0.3, 0.3}), 0);
  EXPECT_EQ(orient2d({0.1, 0.1}, {0.2, 0.2}, {0.3, 0.30000000000000004}),
            orient2d({0.2, 0.2}, {0.3, 0.30000000000000004}, {0.1, 0.1}));
}

}  // namespace
}  // namespace standoff
