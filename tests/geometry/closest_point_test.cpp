// SPDX-License-Identifier: Apache-2.0
#include "tests/geometry/closest_point.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>

#include "geometry/predicates.h"
#include "geometry/triangle_distance.h"
#include "standoff/vec.h"
#include "tests/support/random_mesh.h"

namespace standoff::testing {
namespace {

using Point = Triple<double>;

Point point(Vec3 v) { return {v.x, v.y, v.z}; }

double distance(Vec3 p, const Corners& t) {
  return std::sqrt(origin_distance_sq(point(t[0] - p), point(t[1] - p), point(t[2] - p)));
}

// The same distance in quadruple precision and another way: the nearest of the face's plane, where the foot lies
// between the planes through the edges, and the edges.
using Quad = __float128;
struct Wide {
  Quad x, y, z;
};
Wide operator-(Wide a, Wide b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
Quad inner(Wide a, Wide b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Wide outer(Wide a, Wide b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }

Quad reference_sq(Vec3 at, const Corners& t) {
  const auto wide = [](Vec3 v) { return Wide{v.x, v.y, v.z}; };
  const Wide p = wide(at), corner[3] = {wide(t[0]), wide(t[1]), wide(t[2])};
  const Wide n = outer(corner[1] - corner[0], corner[2] - corner[0]);
  bool above = inner(n, n) > 0;
  Quad best = 1e300;
  for (int k = 0; k < 3; ++k) {
    const Wide a = corner[k], ab = corner[(k + 1) % 3] - a, ap = p - a;
    above = above && inner(outer(n, ab), ap) >= 0;
    const Quad length_sq = inner(ab, ab);
    const Quad u = length_sq > 0 ? std::clamp<Quad>(inner(ap, ab) / length_sq, 0, 1) : Quad(0);
    const Wide away = {ap.x - u * ab.x, ap.y - u * ab.y, ap.z - u * ab.z};
    best = std::min(best, inner(away, away));
  }
  if (!above) return best;
  const Quad height = inner(p - corner[0], n);
  return std::min(best, height * height / inner(n, n));
}
double reference(Vec3 p, const Corners& t) { return std::sqrt(static_cast<double>(reference_sq(p, t))); }

// The triangle (0,0,0) (4,0,0) (0,3,0): a point over each region, and its distance by hand.
TEST(ClosestPoint, EveryRegion) {
  struct Case {
    Vec3 p;
    Vec3 closest;
  };
  const Case cases[] = {
      {{1, 1, 2}, {1, 1, 0}},         // face
      {{1, 1, -2}, {1, 1, 0}},        // the other side of it
      {{2, -1, 1}, {2, 0, 0}},        // edge ab
      {{-1, 2, 1}, {0, 2, 0}},        // edge ac
      {{5, 5.5, 1}, {2, 1.5, 0}},     // edge bc: its middle, and its normal (3, 4) from there
      {{-1, -2, 1}, {0, 0, 0}},       // corner a
      {{6, -1, 1}, {4, 0, 0}},        // corner b
      {{-1, 5, 1}, {0, 3, 0}},        // corner c
      {{1, 0, 0}, {1, 0, 0}},         // on an edge
      {{4, 0, 0}, {4, 0, 0}},         // on a corner
      {{0.5, 0.5, 0}, {0.5, 0.5, 0}}  // on the face
  };
  for (const auto& [p, expected] : cases) {
    std::array<int, 3> order{0, 1, 2};
    const Vec3 corner[] = {{0, 0, 0}, {4, 0, 0}, {0, 3, 0}};
    do {
      const Point found =
          closest_on_triangle(point(p), point(corner[order[0]]), point(corner[order[1]]), point(corner[order[2]]));
      EXPECT_NEAR(length(Vec3{found.x, found.y, found.z} - expected), 0, 1e-14)
          << p.x << ' ' << p.y << ' ' << p.z << " order " << order[0] << order[1] << order[2];
    } while (std::ranges::next_permutation(order).found);
  }
}

TEST(ClosestPoint, Degenerate) {
  const Vec3 a{1, 2, 3}, b{5, 2, 3}, middle{3, 2, 3}, p{3, 5, 7};
  EXPECT_DOUBLE_EQ(distance(p, {a, a, a}), length(p - a));
  for (const Corners& segment : {Corners{a, b, b}, Corners{a, a, b}, Corners{a, b, a}, Corners{a, b, middle},
                                 Corners{a, middle, b}, Corners{middle, a, b}})
    EXPECT_DOUBLE_EQ(distance(p, segment), 5);
}

// Slivers down to widths that a double cannot tell from none, seen from near and far.
TEST(ClosestPoint, AsGoodAsQuadruplePrecision) {
  Random random(7);
  double worst = 0;
  for (int n = 0; n < 60000; ++n) {
    Corners t{random.in_cube(1), random.in_cube(1), random.in_cube(1)};
    const double width = std::pow(10, -random.between(0, 18));
    t[2] = t[0] + (t[1] - t[0]) * random.between(-0.5, 1.5) + random.in_cube(width);
    const Vec3 foot = t[0] + (t[1] - t[0]) * random.between(0, 1) + (t[2] - t[0]) * random.between(0, 1);
    const Vec3 p = foot + random.in_cube(std::pow(10, -random.between(-1, 16)));
    const double error = std::abs(distance(p, t) - reference(p, t));
    worst = std::max(worst, error);
  }
  EXPECT_LT(worst, 1e-8);  // measured: 2.1e-9; small against the promise that it serves to test, 1.6e-5 of a sample
}

bool same_bits(const Point& a, const Point& b) {
  return std::bit_cast<std::array<std::uint64_t, 3>>(std::array{a.x, a.y, a.z}) ==
         std::bit_cast<std::array<std::uint64_t, 3>>(std::array{b.x, b.y, b.z});
}

// Triangles that share an edge agree about it, so that the lowest index decides between them.
TEST(ClosestPoint, AnEdgeIsTheSameFromBothEnds) {
  Random random(8);
  for (int n = 0; n < 100000; ++n) {
    const double size = std::pow(10, random.between(-60, 60));
    const Point a = point(random.in_cube(1) * size),
                b = point(random.in_cube(std::pow(10, random.between(-9, 2))) * size);
    ASSERT_TRUE(same_bits(nearest_on_edge(a, b), nearest_on_edge(b, a))) << n;
    ASSERT_TRUE(same_bits(nearest_on_edge(a, a + b), nearest_on_edge(a + b, a))) << n;
  }
}

// Where an edge or a corner is nearest. Between corners of a face, rounding may depend on their order.
TEST(ClosestPoint, AnEdgesDistanceIsTheSameInEveryOrderOfCorners) {
  Random random(9);
  for (int n = 0; n < 30000; ++n) {
    const Vec3 a = random.in_cube(1), b = random.in_cube(1), p = (a + b) * random.between(0.5, 2);
    // Both triangles fall away from the point, so that it is in front of the edge or beyond its ends.
    const auto third = [&] { return (a + b) * 0.5 - p * random.between(1, 3); };
    const Vec3 c = third(), d = third();
    const auto sq = [&](Vec3 u, Vec3 v, Vec3 w) {
      return origin_distance_sq(point(u - p), point(v - p), point(w - p));
    };
    const Point edge = nearest_on_edge(point(a - p), point(b - p));
    const double expected = dot(edge, edge);
    if (expected > reference_sq(p, {a, c, c}) || expected > reference_sq(p, {b, d, d})) continue;
    for (const Vec3& w : {c, d})
      for (const Corners& t :
           {Corners{a, b, w}, Corners{b, a, w}, Corners{a, w, b}, Corners{b, w, a}, Corners{w, a, b}, Corners{w, b, a}})
        ASSERT_EQ(sq(t[0], t[1], t[2]), expected) << n;
  }
}

}  // namespace
}  // namespace standoff::testing
