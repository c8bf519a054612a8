// SPDX-License-Identifier: Apache-2.0
// Solids in solids, across each other and through themselves: which samples are inside follows from formulas.
#include <gtest/gtest.h>

#include "tests/sign/cases/known_sides.h"
#include "tests/sign/cases/solids.h"
#include "tests/support/sanitized.h"

namespace standoff {
namespace {

using namespace testing;  // NOLINT: a test of what that folder has

constexpr SignOptions by_rule(WindingRule rule) { return {.method = SignMethod::winding, .rule = rule}; }

// Octahedra of radius 1 to `count` about the origin, the outermost oriented outwards. All numbers are dyadic: |x| + |y|
// + |z| is exact.
Mesh shells(int count, bool alternate) {
  Mesh mesh;
  for (int n = 1; n <= count; ++n) append(mesh, octahedron(n, alternate && (count - n) % 2 != 0));
  return mesh;
}

int shells_about(Vec3 p, int count) {
  const double norm = std::abs(p.x) + std::abs(p.y) + std::abs(p.z);
  return norm >= count ? 0 : count - static_cast<int>(std::floor(norm));
}
auto in_some_of(int count) {
  return [=](Vec3 p) { return side_of(shells_about(p, count) > 0); };
}
auto in_an_odd_number_of(int count) {
  return [=](Vec3 p) { return side_of(shells_about(p, count) % 2 != 0); };
}

constexpr double kThin = 0.25;
Grid grid_of_shells(int count) {
  const double step = count / 2000.0;
  return {{24, 16, 8}, Vec3{-2010.125, -1100.0625, -400.3125} * step, Vec3{172.5, 149.25, 114.75} * step};
}

TEST(NestedCases, ThousandsOfShellsOfAlternatingOrientation) {
  constexpr int kCount = kSanitized ? 100 : 2000;
  const Mesh mesh = shells(kCount, true);
  for (const SignOptions& sign : {kWinding, kParity, by_rule(WindingRule::odd), by_rule(WindingRule::nonzero)}) {
    const SignReport report = expect_sides(mesh, grid_of_shells(kCount), sign, in_an_odd_number_of(kCount), kThin);
    EXPECT_EQ(report.flipped, 0);
    EXPECT_EQ(report.boundary_edges, 0);
    EXPECT_TRUE(report.sure);
  }
}

TEST(NestedCases, ShellsOfAlternatingOrientationTheAutomaticWay) {
  constexpr int kCount = 256;
  const SignReport report =
      expect_sides(shells(kCount, true), grid_of_shells(kCount), kAutomatic, in_an_odd_number_of(kCount), kThin);
  EXPECT_EQ(report.method, SignMethod::winding);
  EXPECT_TRUE(report.sure);
}

TEST(NestedCases, ThousandsOfShellsOrientedAlike) {
  constexpr int kCount = 2000;
  const Mesh mesh = shells(kCount, false);
  const Grid grid = grid_of_shells(kCount);
  for (const SignOptions& sign : {kWinding, by_rule(WindingRule::nonzero), kFlood})
    expect_sides(mesh, grid, sign, in_some_of(kCount), kThin);
  for (const SignOptions& sign : {kParity, by_rule(WindingRule::odd)})
    expect_sides(mesh, grid, sign, in_an_odd_number_of(kCount), kThin);
}

// A torus in a box: turned inside out it is a cavity, else a solid in a solid.
TEST(NestedCases, TorusInABox) {
  const Mesh outer = box({-0.5, -1.5, -1.5}, {0.5, 1.5, 1.5}), ring = torus(40, 20);
  const Convex in_box(outer);
  const RoundTorus in_ring(40, 20, 1, 0.3);
  const auto with_cavity = [&](Vec3 p) { return except(in_box(p), in_ring(p)); };
  const Mesh cavity = joined(outer, reversed(ring)), solid = joined(outer, ring);
  const Grid grid = grid_around(outer, 30);
  for (const SignOptions& sign :
       {kWinding, kParity, kAutomatic, by_rule(WindingRule::odd), by_rule(WindingRule::nonzero)})
    EXPECT_EQ(expect_sides(cavity, grid, sign, with_cavity).flipped, 0);
  for (const SignOptions& sign : {kWinding, kAutomatic, by_rule(WindingRule::nonzero), kFlood})
    EXPECT_EQ(expect_sides(solid, grid, sign, in_box).flipped, 0);
  expect_sides(cavity, grid, kFlood, in_box);  // what cannot be reached from outside is not outside
  for (const SignOptions& sign : {kParity, by_rule(WindingRule::odd)}) expect_sides(solid, grid, sign, with_cavity);
}

TEST(NestedCases, OverlappingSolids) {
  const Mesh a = box({0, 0, 0}, {2, 2, 2}), b = box({1, 1, 1}, {3, 3, 3}), c = moved(sphere(12), {1.5, 1.5, 1.5}, 1.2);
  const std::vector<Convex> solids{Convex(a), Convex(b), Convex(c)};
  const Mesh mesh = joined(joined(a, b), c);
  const Grid grid = grid_around(mesh, 28);
  const auto in_odd_number = [&](Vec3 p) {
    int inside = 0;
    for (const Convex& solid : solids) {
      const Side one = solid(p);
      if (one == Side::unknown) return one;
      inside += one == Side::inside;
    }
    return side_of(inside % 2 != 0);
  };
  const auto in_union = [&](Vec3 p) { return in_any(solids, p); };
  for (const SignOptions& sign : {kWinding, kAutomatic, by_rule(WindingRule::nonzero), kFlood})
    expect_sides(mesh, grid, sign, in_union);
  for (const SignOptions& sign : {kParity, by_rule(WindingRule::odd)}) expect_sides(mesh, grid, sign, in_odd_number);
}

// The winding number of a closed polygon about a point of the plane, by half-open crossings of the ray to +x.
int polygon_winding(const std::vector<std::pair<double, double>>& polygon, double x, double y) {
  int winding = 0;
  for (std::size_t n = 0; n < polygon.size(); ++n) {
    const auto [ax, ay] = polygon[n];
    const auto [bx, by] = polygon[(n + 1) % polygon.size()];
    if ((ay <= y) == (by <= y)) continue;
    const double side = (bx - ax) * (y - ay) - (x - ax) * (by - ay);  // above 0: the point is on the edge's left
    winding += ay <= y ? side > 0 : -(side < 0);
  }
  return winding;
}

template <class IsInside>
auto in_prism(std::vector<std::pair<double, double>> polygon, IsInside is_inside) {
  return [=](Vec3 p) { return side_of(p.z > 0 && p.z < 1 && is_inside(polygon_winding(polygon, p.x, p.y))); };
}
bool positive(int winding) { return winding > 0; }
bool nonzero(int winding) { return winding != 0; }
bool odd(int winding) { return winding % 2 != 0; }

// A pentagram winds twice about its middle. A figure of eight winds to the left about one lobe, to the right about the
// other, which is smaller.
TEST(NestedCases, SolidsThatIntersectThemselves) {
  std::vector<std::pair<double, double>> star, eight{{-3, -2}, {1.5, 1}, {1.5, -1}, {-3, 2}};
  for (int n = 0; n < 5; ++n) star.push_back({std::cos(0.1 + 0.8 * M_PI * n), std::sin(0.1 + 0.8 * M_PI * n)});
  ASSERT_EQ(polygon_winding(star, 0, 0), 2);
  ASSERT_EQ(polygon_winding(eight, -1, 0), 1);
  ASSERT_EQ(polygon_winding(eight, 1, 0), -1);
  for (const auto& polygon : {star, eight}) {
    const Mesh mesh = prism(polygon);
    const Grid grid = grid_around(mesh, 31);
    for (const bool as_oriented : {false, true}) {
      const auto options = [&](WindingRule rule) {
        return SignOptions{.method = SignMethod::winding, .rule = rule, .as_oriented = as_oriented};
      };
      expect_sides(mesh, grid, options(WindingRule::positive), in_prism(polygon, positive));
      expect_sides(mesh, grid, options(WindingRule::nonzero), in_prism(polygon, nonzero));
      expect_sides(mesh, grid, options(WindingRule::odd), in_prism(polygon, odd));
    }
    expect_sides(mesh, grid, kParity, in_prism(polygon, odd));
  }
}

}  // namespace
}  // namespace standoff
