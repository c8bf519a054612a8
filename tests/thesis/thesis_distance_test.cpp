// SPDX-License-Identifier: Apache-2.0
#include "thesis/thesis_distance.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "tests/support/random_mesh.h"
#include "tests/support/reference.h"

namespace standoff::testing {
namespace {

constexpr double kEpsilon = 0x1p-23;  // of float

Triple<float> narrow(Vec3 v) { return thesis_rounded<float>(v); }

double exact_distance(Vec3 p, const std::array<Vec3, 3>& t) { return reference_distance(p, t[0], t[1], t[2]); }

double thesis_distance(Vec3 p, const std::array<Vec3, 3>& t) {
  return std::sqrt(distance_sq(make_thesis_triangle<float>(t[0], t[1], t[2]), narrow(p)));
}

// Points around, on and just beside the triangle, representable in float, so that only the arithmetic is judged.
Vec3 point_near(const std::array<Vec3, 3>& t, Random& random) {
  double u = random.between(-0.3, 1.3), v = random.between(-0.3, 1.3);
  if (random.between(0, 1) < 0.3) v = 1 - u;
  const double far = std::pow(10, random.between(-6, 1));
  const Vec3 p = t[0] + (t[1] - t[0]) * u + (t[2] - t[0]) * v + random.in_cube(far);
  return {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
}

// The largest error over random points near triangles whose third corner lies `width` lengths beside the first edge, in
// units of the diameter of the box around both and the origin times epsilon.
double largest_error(double width, unsigned seed) {
  Random random(seed);
  double largest = 0;
  for (int n = 0; n < 2000; ++n) {
    const Vec3 a = random.in_cube(8), b = random.in_cube(8);
    const Vec3 c = a + (b - a) * random.between(-0.2, 1.2) + random.in_cube(1) * (width * length(b - a));
    std::array<Vec3, 3> t{a, b, c};
    std::ranges::shuffle(t, std::mt19937(seed + n));
    for (int m = 0; m < 20; ++m) {
      const Vec3 p = point_near(t, random);
      Box box;
      for (const Vec3 v : {a, b, c, p, Vec3{}}) box.include(v);
      const double error = std::abs(thesis_distance(p, t) - exact_distance(p, t));
      largest = std::max(largest, error / (length(box.extent()) * kEpsilon));
    }
  }
  return largest;
}

TEST(ThesisDistance, MeetsEveryRegion) {
  const std::array<Vec3, 3> t{Vec3{0, 0, 0}, Vec3{4, 0, 0}, Vec3{0, 4, 0}};
  const struct {
    Vec3 point;
    double distance;
  } cases[] = {
      {{1, 1, 0}, 0},   {{1, 1, -3}, 3},                                              // face
      {{2, -3, 0}, 3},  {{2, -3, 4}, 5}, {{-3, 2, 4}, 5}, {{4, 4, 0}, std::sqrt(8)},  // edges
      {{-3, -4, 0}, 5}, {{7, -4, 0}, 5}, {{-3, 8, 0}, 5}, {{0, 0, 2}, 2},             // corners
  };
  for (const auto& c : cases) EXPECT_NEAR(thesis_distance(c.point, t), c.distance, 1e-6);
}

TEST(ThesisDistance, StaysWithinItsStatedErrorOnAnyTriangle) {
  for (int digits = 0; digits <= 10; ++digits) {
    const double error = largest_error(digits == 10 ? 0 : std::pow(10, -digits), 7);
    EXPECT_LE(error, 2) << "width 1e-" << digits;
    RecordProperty("error_at_width_1e-" + std::to_string(digits), std::to_string(error));
  }
}

TEST(ThesisDistance, TakesCornersInAnyOrder) {
  Random random(3);
  for (int n = 0; n < 200; ++n) {
    std::array<Vec3, 3> t{random.in_cube(4), random.in_cube(4), random.in_cube(4)};
    const Vec3 p = point_near(t, random);
    const double expected = exact_distance(p, t);
    std::array<int, 3> order{0, 1, 2};
    do {
      EXPECT_NEAR(thesis_distance(p, {t[order[0]], t[order[1]], t[order[2]]}), expected, 40 * 2 * kEpsilon);
    } while (std::ranges::next_permutation(order).found);
  }
}

TEST(ThesisDistance, TakesDegenerateTriangles) {
  const Vec3 a{1, 2, 3}, b{4, 6, 3}, middle{2.5, 4, 3};
  Random random(4);
  for (int n = 0; n < 200; ++n) {
    const Vec3 p = point_near({a, b, a + Vec3{0, 0, 1}}, random);
    const double to_segment = exact_distance(p, {a, b, b}), to_point = length(p - a);
    for (const auto& t : {std::array{a, a, b}, {a, b, a}, {b, a, a}, {a, b, middle}, {middle, a, b}, {b, middle, a}})
      EXPECT_NEAR(thesis_distance(p, t), to_segment, 40 * 2 * kEpsilon);
    EXPECT_NEAR(thesis_distance(p, {a, a, a}), to_point, 40 * 2 * kEpsilon);
  }
}

}  // namespace
}  // namespace standoff::testing
