// SPDX-License-Identifier: Apache-2.0
// Meshes of which nothing is known but their triangles: the side is that of the sum of all solid angles, everywhere,
// whichever rule, whatever the grid.
#include <gtest/gtest.h>

#include "tests/sign/cases/known_sides.h"
#include "tests/sign/cases/solids.h"

namespace standoff {
namespace {

using namespace testing;  // NOLINT: a test of what that folder has

// The winding number as triangles are oriented, with each rule.
void expect_brute_force_sides(const Mesh& mesh, const Grid& grid) {
  for (const WindingRule rule : {WindingRule::positive, WindingRule::nonzero, WindingRule::odd}) {
    SCOPED_TRACE(static_cast<int>(rule));
    const SignOptions sign{.method = SignMethod::winding, .rule = rule, .as_oriented = true};
    expect_sides(mesh, grid, sign, ByWinding(mesh, grid, rule));
  }
}

TEST(SoupCases, LooseTriangles) {
  for (unsigned seed = 0; seed < 4; ++seed) {
    const Mesh mesh = random_soup(seed, 60, 1, 0.7);
    expect_brute_force_sides(mesh, grid_around(mesh, 14));
  }
}

// All alike oriented, many deep: winding numbers far above 1, and everything between.
TEST(SoupCases, TrianglesThatLookOutwards) {
  Random random(3);
  Mesh mesh;
  for (int n = 0; n < 120; ++n) {
    const Vec3 at = random.in_cube(1), a = at + random.in_cube(0.8), b = at + random.in_cube(0.8),
               c = at + random.in_cube(0.8);
    dot(a + b + c, cross(b - a, c - a)) > 0 ? add_triangle(mesh, a, b, c) : add_triangle(mesh, a, c, b);
  }
  expect_brute_force_sides(mesh, grid_around(mesh, 15));
}

// Corners on a lattice: triangles that touch, repeat, overlap and have no area. Samples are off the lattice, and on it.
TEST(SoupCases, TrianglesOnALattice) {
  for (unsigned seed = 0; seed < 4; ++seed) {
    SCOPED_TRACE(seed);
    const Mesh mesh = nasty_soup(seed, 60, 3);
    expect_brute_force_sides(mesh, grid_around(mesh, 13));
    expect_brute_force_sides(mesh, {{13, 13, 13}, {-4, -4.25, -3.75}, {0.625, 0.625, 0.625}});
  }
}

// A hole's edge along rows of samples, and in their planes.
TEST(SoupCases, HolesAlignedWithTheGrid) {
  Mesh open = box({-1, -1, -1}, {1, 1, 1});
  open.triangles.erase(open.triangles.begin() + 4, open.triangles.begin() + 8);  // y = -1 and y = 1
  const Grid grid{{17, 17, 17}, {-2, -2, -2}, {0.25, 0.25, 0.25}};
  expect_brute_force_sides(open, grid);
  for (std::size_t t = 0; t < 8; ++t) expect_brute_force_sides(without(open, t), grid);
}

TEST(SoupCases, SurfacesWithoutAnInside) {
  for (const Mesh& mesh : {terrain(9, 0.4), moebius(16, 3), klein_bottle(16, 7)}) {
    expect_brute_force_sides(mesh, grid_around(mesh, 14));
    std::int64_t turned = 0;
    const Mesh random = randomly_turned(mesh, 1, turned);
    expect_brute_force_sides(random, grid_around(mesh, 14));
  }
}

// What is far from the grid counts as well as what is near, and what is small as well as what is large.
TEST(SoupCases, FarAndNearAndLargeAndSmall) {
  for (unsigned seed = 0; seed < 4; ++seed) {
    Mesh mesh = random_soup(seed, 25, 1, 1);
    mesh = joined(std::move(mesh), random_soup(seed + 50, 10, 1000, 900));
    mesh = joined(std::move(mesh), random_soup(seed + 60, 25, 0.5, 1e-4));
    expect_brute_force_sides(mesh, {{14, 13, 12}, {-1.1, -1.2, -1.3}, {0.17, 0.18, 0.19}});
    expect_brute_force_sides(mesh, {{14, 13, 12}, {-1900, -1800, -2000}, {291, 267, 313}});
  }
}

}  // namespace
}  // namespace standoff
