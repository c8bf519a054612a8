// SPDX-License-Identifier: Apache-2.0
// The answers that the zoo's tests hold against standoff, against others: whole numbers against those of any length,
// the exact touch against determinants of small whole numbers, gaps against points drawn at random, translations
// against prisms.
#include <gtest/gtest.h>

#include "tests/collision/exact_sign.h"
#include "tests/collision/zoo/animals.h"
#include "tests/collision/zoo/gap.h"
#include "tests/collision/zoo/swept_depth.h"

namespace standoff {
namespace {

using namespace standoff::testing;

TEST(ZooOracle, IntegersAreThoseOfAnyLength) {
  Random random(1);
  const auto number = [&] { return std::ldexp(random.between(-1, 1), static_cast<int>(random.below(70))); };
  for (int n = 0; n < 20'000; ++n) {
    const double a = number(), b = number(), c = number(), d = number();
    const auto whole = [](double v) { return integer_of<4>(v, -100); };
    const auto of_any_length = [](double v) { return scaled(v, -100); };
    const auto x = whole(a) * whole(b) - whole(c) * whole(d);
    const Whole y = of_any_length(a) * of_any_length(b) - of_any_length(c) * of_any_length(d);
    ASSERT_EQ(x.negative(), y < Whole{});
    ASSERT_EQ(x.zero(), !(y < Whole{}) && !(Whole{} < y));
    const auto less = whole(a) * whole(b) < whole(c) * whole(d);
    ASSERT_EQ(less, of_any_length(a) * of_any_length(b) < of_any_length(c) * of_any_length(d));
    // Fewer limbs, the same number.
    ASSERT_EQ(float_of<double>(integer_of<2>(a, -40)), std::ldexp(a, 40));
    ASSERT_EQ(float_of<double>(integer_of<2>(a, -40) * integer_of<1>(-3, 0)), std::ldexp(-3 * a, 40));
  }
}

// Segment and triangle on a lattice, by determinants; what is flat by its parts. Not standoff's method either: all in
// int64.
using Point = std::array<std::int64_t, 3>;
std::int64_t det(const Point& a, const Point& b, const Point& c, const Point& d) {
  const auto x = crossed<std::int64_t>(b - a, c - a);
  return dotted<std::int64_t>(x, d - a);
}
bool on_segment(const Point& x, const Point& a, const Point& b) {
  if (crossed<std::int64_t>(b - a, x - a) != Point{}) return false;
  for (int k = 0; k < 3; ++k)
    if (x[k] < std::min(a[k], b[k]) || x[k] > std::max(a[k], b[k])) return false;
  return true;
}
bool in_triangle(const Point& x, const Point (&t)[3]) {
  for (int k = 0; k < 3; ++k)
    if (on_segment(x, t[k], t[(k + 1) % 3])) return true;
  const Point n = crossed<std::int64_t>(t[1] - t[0], t[2] - t[0]);
  if (n == Point{} || dotted<std::int64_t>(n, x - t[0]) != 0) return false;
  for (int k = 0; k < 3; ++k)
    if (dotted<std::int64_t>(crossed<std::int64_t>(t[(k + 1) % 3] - t[k], x - t[k]), n) < 0) return false;
  return true;
}
bool segments_cross(const Point& a, const Point& b, const Point& c, const Point& d) {
  if (on_segment(a, c, d) || on_segment(b, c, d) || on_segment(c, a, b) || on_segment(d, a, b)) return true;
  if (det(a, b, c, d) != 0) return false;
  const Point u = b - a, v = d - c, n = crossed<std::int64_t>(u, v);
  if (n == Point{}) return false;
  // c = a + s u - t v with 0 <= s, t <= 1.
  const std::int64_t all = dotted<std::int64_t>(n, n), s = dotted<std::int64_t>(crossed<std::int64_t>(c - a, v), n),
                     t = dotted<std::int64_t>(crossed<std::int64_t>(c - a, u), n);
  return s >= 0 && s <= all && t >= 0 && t <= all;
}
bool pierces(const Point& a, const Point& b, const Point (&t)[3]) {
  const auto from = det(t[0], t[1], t[2], a), to = det(t[0], t[1], t[2], b);
  if (!((from > 0 && to < 0) || (from < 0 && to > 0))) return false;
  int left = 0, right = 0;
  for (int k = 0; k < 3; ++k) {
    const auto side = det(a, b, t[k], t[(k + 1) % 3]);
    left += side >= 0, right += side <= 0;
  }
  return left == 3 || right == 3;
}
bool touch_by_parts(const Point (&p)[3], const Point (&q)[3]) {
  for (int i = 0; i < 3; ++i) {
    const Point &a = p[i], &b = p[(i + 1) % 3], &c = q[i], &d = q[(i + 1) % 3];
    if (in_triangle(a, q) || in_triangle(c, p) || pierces(a, b, q) || pierces(c, d, p)) return true;
    for (int j = 0; j < 3; ++j)
      if (segments_cross(a, b, q[j], q[(j + 1) % 3])) return true;
  }
  return false;
}

TEST(ZooOracle, TouchOnALatticeIsThatOfAllParts) {
  for (const double half : {0.9, 1.4, 2.4, 6.0}) {
    Random random(2);
    int touching = 0, unsure = 0;
    constexpr int kPairs = 6000;
    for (int n = 0; n < kPairs; ++n) {
      Corners p, q;
      Point a[3], b[3];
      for (auto [corners, points] : {std::pair{&p, &a}, std::pair{&q, &b}})
        for (int k = 0; k < 3; ++k) {
          const Vec3 v = random.in_cube(half);
          Vec3& at = (*corners)[k] = {std::round(v.x), std::round(v.y), std::round(v.z)};
          (*points)[k] = {static_cast<std::int64_t>(at.x), static_cast<std::int64_t>(at.y),
                          static_cast<std::int64_t>(at.z)};
        }
      const bool expected = touch_by_parts(a, b);
      ASSERT_EQ(touch(p, q), expected) << n;
      ASSERT_EQ(touch_without_filter(p, q), expected) << n;
      ASSERT_EQ(touch_in_integers<2>(p, q, -3), expected) << n;
      if (n % 100 == 0) {
        ASSERT_EQ(touch_in_integers<20>(p, q, -700), expected) << n;
      }
      unsure += touch_in_doubles(p, q) == Sure::no;
      touching += expected;
      // On the lattice no gap is small but none.
      if (!expected) {
        ASSERT_GT(gap(p, q), 1e-4) << n;
      }
    }
    EXPECT_GT(touching, kPairs / 20);
    EXPECT_LT(touching, kPairs * 19 / 20);
    EXPECT_GT(unsure, 100);
  }
}

// The filter is for speed alone.
TEST(ZooOracle, TheFilterChangesNothing) {
  Random random(3);
  int sure[3] = {};
  for (int n = 0; n < 20'000; ++n) {
    const double ratio = std::pow(10, -static_cast<double>(random.below(16)));
    const SliverPair pair = sliver_pair(random, ratio, static_cast<Thin>(n % 2), static_cast<TriangleOverlap>(n % 3));
    const Pose pose = random_pose(random, n % 5 == 0 ? 1e3 : 1);
    const auto at = [&](const Corners& t) { return Corners{apply(pose, t[0]), apply(pose, t[1]), apply(pose, t[2])}; };
    const Corners p = at(pair.p), q = at(pair.q);
    const bool expected = touch_without_filter(p, q);
    ASSERT_EQ(touch(p, q), expected) << n;
    ASSERT_EQ(touch(q, p), expected) << n;
    ASSERT_EQ(touch({p[1], p[2], p[0]}, {q[2], q[1], q[0]}), expected) << n;
    ++sure[static_cast<int>(touch_in_doubles(p, q))];
  }
  for (const int count : sure) EXPECT_GT(count, 1000);
}

// Points that go back and forth to the nearest one of the other triangle come ever nearer, and never nearer than the
// gap.
TEST(ZooOracle, GapsAreThoseOfNearestPoints) {
  Random random(4);
  double worst = 0;
  for (int n = 0; n < 3000; ++n) {
    const double ratio = std::pow(10, -static_cast<double>(random.below(16)));
    SliverPair pair = sliver_pair(random, ratio, static_cast<Thin>(n % 2), TriangleOverlap::anywhere);
    if (n % 7 == 0) pair.p[2] = pair.p[n % 2];                   // segments
    if (n % 11 == 0) pair.q[0] = pair.q[1] = pair.q[2];          // points
    if (n % 13 == 0) pair.p[1] = (pair.p[0] + pair.p[2]) * 0.5;  // three on a line, nearly
    const double found = gap(pair.p, pair.q);
    if (found == 0) continue;
    const auto drawn = [&](const Corners& t) {
      double s = random.between(0, 1), u = random.between(0, 1);
      if (s + u > 1) s = 1 - s, u = 1 - u;
      return t[0] + (t[1] - t[0]) * s + (t[2] - t[0]) * u;
    };
    double least = 1e300;
    for (int k = 0; k < 200; ++k) {
      const Vec3 translation = drawn(pair.p) - drawn(pair.q);
      least = std::min(least, length(translation));
    }
    ASSERT_GE(least, found * (1 - 1e-15)) << n;
    for (const Vec3& v : pair.p) least = std::min(least, root_of(point_triangle_sq(v, pair.q)));
    for (const Vec3& v : pair.q) least = std::min(least, root_of(point_triangle_sq(v, pair.p)));
    worst = std::max(worst, least - found);
    ASSERT_GE(least, found * (1 - 1e-15)) << n;
    ASSERT_NEAR(gap(pair.q, pair.p), found, 1e-17) << n;
  }
  EXPECT_GT(worst, 1e-3) << "two edges are nearest sometimes";
}

// On a lattice positions on a path are exact: where the triangles touch at one of them, and where they go deep into
// each other, as another test of prisms has it.
TEST(ZooOracle, DepthsOnAWayAreThoseOfThePrism) {
  Random random(5);
  int through = 0, beside = 0, met = 0;
  for (int n = 0; n < 5000; ++n) {
    const auto triangle = [&] {
      Corners t;
      for (Vec3& v : t) v = rounded(random.in_cube(6.4));
      return t;
    };
    const Corners p = triangle(), q = triangle();
    constexpr int kPlaces = 64;
    const Vec3 step = rounded(random.in_cube(0.7)) * 0.25, translation = step * kPlaces;
    const double depth = swept_depth(p, translation, q);
    bool touching = false;
    for (int k = 0; k <= kPlaces; ++k) {
      const Vec3 by = step * k;
      touching = touching || touch({p[0] + by, p[1] + by, p[2] + by}, q);
    }
    ASSERT_TRUE(!touching || depth >= 0) << n;
    met += touching;
    if (std::abs(depth) < 1e-9) continue;  // touching, or flat
    ASSERT_EQ(stays_out(p, translation, q, 0), depth < 0) << n;
    if (depth > 0) {
      ASSERT_TRUE(stays_out(p, translation, q, depth * (1 + 1e-9))) << n;
      ASSERT_FALSE(stays_out(p, translation, q, depth * (1 - 1e-9))) << n;
    }
    (depth > 0 ? through : beside)++;
  }
  EXPECT_GT(through, 500);
  EXPECT_GT(beside, 500);
  EXPECT_GT(met, 500);
}

}  // namespace
}  // namespace standoff
