// SPDX-License-Identifier: Apache-2.0
#include "geometry/triangle_frame.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "geometry/predicates.h"
#include "tests/geometry/closest_point.h"
#include "tests/support/random_mesh.h"
#include "tests/support/reference.h"

namespace standoff::testing {
namespace {

template <class F>
Triple<F> rounded_point(Vec3 v) {
  return {static_cast<F>(v.x), static_cast<F>(v.y), static_cast<F>(v.z)};
}
Vec3 exactly(const Triple<float>& p) { return {p.x, p.y, p.z}; }
Vec3 exactly(const Triple<double>& p) { return {p.x, p.y, p.z}; }

// Corners and point are rounded to F first: their rounding is not the frame's.
template <class F>
struct Rounded {
  Triple<F> a, b, c, p;
  Rounded(const Corners& t, Vec3 at)
      : a(rounded_point<F>(t[0])), b(rounded_point<F>(t[1])), c(rounded_point<F>(t[2])), p(rounded_point<F>(at)) {}
  double reference() const { return reference_distance(exactly(p), exactly(a), exactly(b), exactly(c)); }
  TriangleFrame<F> frame(double least_sq) const { return make_frame(a, b, c, static_cast<F>(least_sq)); }
};

// Triangles in the unit ball around the reference point: any, needles down to nothing, segments, points.
Corners random_triangle(Random& random) {
  const double half = 1 / std::sqrt(3.0), width = std::pow(10, -random.between(0, 9));
  const Vec3 a = random.in_cube(half), b = random.in_cube(half);
  switch (random.below(6)) {
    case 0:
      return {a, b, random.in_cube(half)};
    case 1:
      return {a, b, b};
    case 2:
      return {a, a, a};
    case 3:
      return {a, a * 0.9 + random.in_cube(width * 0.05), a * 0.9 + random.in_cube(width * 0.05)};
    default:
      return {a, b, (a + (b - a) * random.between(0, 1)) * 0.9 + random.in_cube(width * 0.05)};
  }
}

Vec3 random_point(Random& random, const Corners& t) {
  if (random.below(2) == 0) return random.in_cube(1 / std::sqrt(3.0));
  const double u = random.between(0, 1), v = random.between(0, 1 - u);
  return (t[0] + (t[1] - t[0]) * u + (t[2] - t[0]) * v) * 0.99 + random.in_cube(std::pow(10, -random.between(2, 7)));
}

TEST(TriangleFrame, ErrorIsWithinTheStatedBound) {
  Random random(71);
  constexpr double kBound = 32 * 0x1p-23;
  double worst = 0;
  for (int n = 0; n < 200000; ++n) {
    const Corners t = random_triangle(random);
    const Rounded<float> r(t, random_point(random, t));
    worst = std::max(worst, std::abs(std::sqrt(distance_sq(r.frame(6e-16), r.p)) - r.reference()));
  }
  RecordProperty("largest_error_in_epsilon", std::to_string(worst / 0x1p-23));
  EXPECT_LE(worst, kBound);
  EXPECT_GE(worst, kBound / 100) << "the bound could be stated far tighter";
}

TEST(TriangleFrame, ErrorInDoubleIsWithinTheSameBound) {
  Random random(72);
  for (int n = 0; n < 50000; ++n) {
    const Corners t = random_triangle(random);
    const Rounded<double> r(t, random_point(random, t));
    ASSERT_NEAR(std::sqrt(distance_sq(r.frame(1e-30), r.p)), r.reference(), 12 * 0x1p-52);
  }
}

TEST(TriangleFrame, ClosestPointLiesOnTheTriangleAtTheDistance) {
  Random random(73);
  for (int n = 0; n < 100000; ++n) {
    const Corners t = random_triangle(random);
    const Rounded<double> r(t, random_point(random, t));
    const TriangleFrame<double> frame = r.frame(1e-24);
    const Vec3 closest = exactly(closest_in_frame(frame, r.p));
    ASSERT_NEAR(length(closest - exactly(r.p)), r.reference(), 1e-12);
    ASSERT_LE(reference_distance(closest, exactly(r.a), exactly(r.b), exactly(r.c)), 1e-12);
    const Vec3 other = exactly(closest_on_triangle(r.p, r.a, r.b, r.c));
    ASSERT_LE(length(closest - other), 1e-7) << "one closest point by two ways";
  }
}

TEST(TriangleFrame, AllOrdersOfCorners) {
  const Corners corner{Vec3{0, 0, 0}, Vec3{4, 0, 0}, Vec3{1, 2, 0}};
  Random random(74);
  for (int n = 0; n < 500; ++n) {
    const Vec3 p = random.in_cube(6);
    const double expected = reference_distance(p, corner[0], corner[1], corner[2]);
    std::array<int, 3> order{0, 1, 2};
    do {
      const Rounded<double> r({corner[order[0]], corner[order[1]], corner[order[2]]}, p);
      ASSERT_NEAR(std::sqrt(distance_sq(r.frame(1e-40), r.p)), expected, 1e-14);
    } while (std::ranges::next_permutation(order).found);
  }
}

TEST(TriangleFrame, SegmentsAndPointsOnALattice) {
  // Two corners in one leave an edge without direction and two that are longest; a point may lie exactly above an apex.
  const Vec3 steps[] = {{0, 0, 0}, {1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, 0, -1}, {1, 0, 1}, {-1, 1, 1}};
  for (const Vec3 step : steps)
    for (const double half_way : {0.0, 0.5, 1.0}) {
      const Corners corner{Vec3{0, 0, 0}, step, step * half_way};
      std::array<int, 3> order{0, 1, 2};
      do {
        for (int n = 0; n < 125; ++n) {
          const Vec3 p{n % 5 - 2.0, n / 5 % 5 - 2.0, n / 25 - 2.0};
          const Rounded<float> r({corner[order[0]], corner[order[1]], corner[order[2]]}, p);
          const double expected = reference_distance(p, {}, step, step * half_way);
          ASSERT_NEAR(std::sqrt(distance_sq(r.frame(1e-12), r.p)), expected, 1e-6);
          const Vec3 closest = exactly(closest_in_frame(r.frame(1e-12), r.p));
          ASSERT_NEAR(length(closest - p), expected, 1e-6);
          ASSERT_LE(reference_distance(closest, {}, step, step * half_way), 1e-6);
        }
      } while (std::ranges::next_permutation(order).found);
    }
}

TEST(TriangleFrame, ShortEdgesAndAltitudesCountAsZero) {
  // Below the square root of least_sq a triangle is its edge or a point: wrong by its width at most.
  const double least = 1e-3;
  const Rounded<double> flat({Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0.4, 0.5e-3, 0}}, {0.4, 1, 0});
  EXPECT_NEAR(std::sqrt(distance_sq(flat.frame(least * least), flat.p)), flat.reference(), least);
  const Rounded<double> small({Vec3{0, 0, 0}, Vec3{0.5e-3, 0, 0}, Vec3{0, 0.5e-3, 0}}, {0, 0, 1});
  EXPECT_NEAR(std::sqrt(distance_sq(small.frame(least * least), small.p)), 1, least);
}

// What the lines are for: points within a brick of large triangles, coordinates in float.
TEST(TriangleLines, AreExactNearTheReferenceHoweverLargeTheTriangle) {
  Random random(75);
  for (const double size : {10.0, 1e3, 1e6, 1e9})
    for (int n = 0; n < 20000; ++n) {
      // An edge or the face passes near the reference point; corners lie anywhere.
      const Vec3 along = random.in_cube(size), near = random.in_cube(5);
      Corners t{near + along * random.between(0, 1), near - along * random.between(0, 1), random.in_cube(size)};
      std::swap(t[0], t[random.below(3)]);
      const Rounded<double> r(t, exactly(rounded_point<float>(random.in_cube(8))));
      const TriangleLines<float> lines = make_lines<float>(r.frame(1e-12));
      const double expected = r.reference(), found = std::sqrt(distance_sq(lines, rounded_point<float>(exactly(r.p))));
      ASSERT_NEAR(found, expected, 1e-6 * (expected + 16) + size * 1e-15) << size;
    }
}

}  // namespace
}  // namespace standoff::testing
