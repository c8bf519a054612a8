// SPDX-License-Identifier: Apache-2.0
// Polygons into triangles: areas, counts and corners, from every starting corner and every side.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <set>
#include <vector>

#include "io/mesh/builder.h"

namespace standoff {
namespace {

std::vector<Triangle> fan(std::uint32_t corners, std::uint32_t first = 0) {
  std::vector<Triangle> triangles;
  const auto corner = [&](std::uint32_t i) { return (first + i) % corners; };
  for (std::uint32_t i = 1; i + 1 < corners; ++i) triangles.push_back({corner(0), corner(i), corner(i + 1)});
  return triangles;
}

Vec3 vector_area(const std::vector<Vec3>& p, const std::vector<Triangle>& triangles) {
  Vec3 sum;
  for (const auto& [a, b, c] : triangles) sum = sum + cross(p[b] - p[a], p[c] - p[a]) * 0.5;
  return sum;
}

double total_area(const std::vector<Vec3>& p, const std::vector<Triangle>& triangles) {
  double sum = 0;
  for (const auto& [a, b, c] : triangles) sum += length(cross(p[b] - p[a], p[c] - p[a])) * 0.5;
  return sum;
}

bool triangulate(const std::vector<Vec3>& p, std::vector<Triangle>& triangles) {
  double work = polygon_work(p.size());
  return triangulate(p, triangles, work);
}

// A planar polygon is covered once exactly where the areas of its triangles add up to its own.
void expect_covered(const std::vector<Vec3>& p) {
  const auto n = static_cast<std::uint32_t>(p.size());
  for (std::uint32_t first = 0; first < n; ++first) {
    auto triangles = fan(n, first);
    const double area = length(vector_area(p, triangles));
    ASSERT_TRUE(triangulate(p, triangles));
    EXPECT_EQ(triangles.size(), n - 2);
    EXPECT_NEAR(total_area(p, triangles), area, 1e-9 * area) << "from corner " << first;
    std::set<std::uint32_t> used;
    for (const Triangle& t : triangles) used.insert(t.begin(), t.end());
    EXPECT_EQ(used.size(), n);
  }
}

// The polygon as it is, turned over, and in the planes of the other axes.
void expect_covered_on_every_side(const std::vector<Vec3>& polygon) {
  for (int turn = 0; turn < 3; ++turn)
    for (const bool over : {false, true}) {
      std::vector<Vec3> p = polygon;
      for (Vec3& v : p)
        for (int t = 0; t < turn; ++t) v = {v.z, v.x, v.y};
      if (over) std::reverse(p.begin(), p.end());
      SCOPED_TRACE(testing::Message() << "axis " << turn << (over ? ", turned over" : ""));
      expect_covered(p);
    }
}

TEST(Polygon, ConvexOnesStayAFan) {
  std::vector<Vec3> p;
  for (int i = 0; i < 12; ++i) p.push_back({std::cos(i * 0.5), std::sin(i * 0.5), 0.25 * std::cos(i * 0.5)});
  auto triangles = fan(12);
  ASSERT_TRUE(triangulate(p, triangles));
  EXPECT_EQ(triangles, fan(12));
  expect_covered_on_every_side(p);
}

TEST(Polygon, ConcaveOnesAreCoveredOnce) {
  expect_covered_on_every_side({{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {1, 0.5, 0}, {0, 2, 0}});           // a notch
  expect_covered_on_every_side({{0, 0, 0}, {3, 0, 0}, {3, 1, 0}, {1, 1, 0}, {1, 3, 0}, {0, 3, 0}});  // an L
  expect_covered_on_every_side({{0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0.1, 0.1, 1}});                    // a dart
  expect_covered_on_every_side(
      {{0, 0, 0}, {4, 0, 1}, {4, 4, 2}, {3, 4, 1.75}, {3, 1, 1}, {1, 1, .5}, {1, 4, 1.25}, {0, 4, 1}});  // a tilted U
}

TEST(Polygon, CornersOnStraightEdgesDoNotMatter) {
  expect_covered_on_every_side(
      {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {2, 1, 0}, {2, 2, 0}, {1, 1, 0}, {0, 2, 0}, {0, 1, 0}});
}

TEST(Polygon, OutlinesJoinedToTheirHoles) {
  expect_covered_on_every_side(
      {{0, 0, 0}, {6, 0, 0}, {6, 6, 0}, {0, 6, 0}, {0, 0, 0}, {2, 2, 0}, {2, 4, 0}, {4, 4, 0}, {4, 2, 0}, {2, 2, 0}});
}

// Star-shaped with random radii: simple by construction, and about half of the corners are reflex.
TEST(Polygon, RandomStarsAreCoveredOnce) {
  std::mt19937 random(1);
  for (const int corners : {5, 8, 13, 40}) {
    std::vector<Vec3> p;
    for (int i = 0; i < corners; ++i) {
      const double angle = 2 * std::numbers::pi * i / corners, radius = 1 + static_cast<double>(random() % 1000) / 200;
      p.push_back({100 + radius * std::cos(angle), radius * std::sin(angle) - 50, 3});
    }
    expect_covered(p);
  }
}

TEST(Polygon, LongCombsAreCoveredOnce) {
  std::vector<Vec3> p{{0, -1, 0}};
  for (int tooth = 0; tooth < 1000; ++tooth) {
    p.push_back({tooth * 1.0, 0, 0});
    p.push_back({tooth + 0.5, 10, 0});
  }
  p.push_back({1000, -1, 0});
  std::reverse(p.begin(), p.end());
  auto triangles = fan(static_cast<std::uint32_t>(p.size()));
  const double area = length(vector_area(p, triangles));
  ASSERT_TRUE(triangulate(p, triangles));
  EXPECT_NEAR(total_area(p, triangles), area, 1e-9 * area);
}

// No right answer, but always the same one, over the given corners.
TEST(Polygon, TangledOnesGetTrianglesAllTheSame) {
  std::mt19937 random(3);
  for (int trial = 0; trial < 200; ++trial) {
    const auto n = 3 + random() % 30;
    std::vector<Vec3> p;
    const auto coordinate = [&] { return static_cast<double>(random() % 4); };
    for (unsigned i = 0; i < n; ++i) p.push_back({coordinate(), coordinate(), coordinate()});
    auto triangles = fan(static_cast<std::uint32_t>(n)), again = triangles;
    ASSERT_TRUE(triangulate(p, triangles));
    ASSERT_TRUE(triangulate(p, again));
    EXPECT_EQ(triangles, again);
    EXPECT_EQ(triangles.size(), n - 2);
    for (const Triangle& t : triangles)
      for (const auto v : t) EXPECT_LT(v, n);
  }
}

TEST(Polygon, TooManyCornersAreRefusedOnlyWhereEarsWouldBeCut) {
  std::vector<Vec3> p;
  const std::size_t n = 40'000;
  for (std::size_t i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(n);
    p.push_back({std::cos(angle), std::sin(angle), 0});
  }
  auto triangles = fan(static_cast<std::uint32_t>(n));
  EXPECT_TRUE(triangulate(p, triangles));
  p[2] = {};
  EXPECT_FALSE(triangulate(p, triangles));
  EXPECT_EQ(triangles, fan(static_cast<std::uint32_t>(n)));
}

// Ten polygons of 32768 corners took 45 seconds: each was allowed, and nobody counted them.
TEST(Polygon, AllOfAMeshShareTheirWork) {
  const std::vector<Vec3> p{{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {1, 0.5, 0}, {0, 2, 0}};
  double work = 60;
  for (const bool allowed : {true, true, false}) {
    auto triangles = fan(5);
    EXPECT_EQ(triangulate(p, triangles, work), allowed);
    EXPECT_EQ(triangles == fan(5), !allowed);
  }
  EXPECT_EQ(work, 10);
  EXPECT_GE(polygon_work(32'768), 32'768.0 * 32'768.0);
  EXPECT_LT(polygon_work(10 * 32'768), 2 * 32'768.0 * 32'768.0);
}

}  // namespace
}  // namespace standoff
