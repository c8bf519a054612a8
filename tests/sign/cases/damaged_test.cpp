// SPDX-License-Identifier: Apache-2.0
// Closed meshes with damage. A flat hole in a convex solid changes no side: within the solid its solid angle is less
// than 2 pi, so the winding number stays above 1/2; outside it stays below. Where holes are not flat, the sum of all
// solid angles tells the side.
#include <gtest/gtest.h>

#include "tests/sign/cases/known_sides.h"
#include "tests/sign/cases/solids.h"

namespace standoff {
namespace {

using namespace testing;  // NOLINT: a test of what that folder has

struct Solid {
  const char* name;
  Mesh mesh;
  std::size_t step;  // of the triangles to damage
};
std::vector<Solid> solids() { return {{"ball", sphere(6), 29}, {"box", box({-1, -1, -1}, {1, 2, 3}), 1}}; }

template <class Use>
void for_each_damage(const Use& use) {
  for (const Solid& solid : solids())
    for (std::size_t t = 0; t < solid.mesh.triangles.size(); t += solid.step) {
      SCOPED_TRACE(std::string(solid.name) + ", triangle " + std::to_string(t));
      use(solid.mesh, t, grid_around(solid.mesh, 12));
    }
}

TEST(DamagedCases, OneTriangleMissing) {
  for_each_damage([](const Mesh& solid, std::size_t t, const Grid& grid) {
    for (const SignOptions& sign : {kWinding, kAutomatic, kAsOriented}) {
      const SignReport report = expect_sides(without(solid, t), grid, sign, Convex(solid));
      EXPECT_EQ(report.method, SignMethod::winding);
      EXPECT_EQ(report.boundary_edges, 3);
      EXPECT_EQ(report.flipped, 0);
    }
  });
}

TEST(DamagedCases, OneTriangleFlipped) {
  for_each_damage([](const Mesh& solid, std::size_t t, const Grid& grid) {
    const Mesh mesh = with_flipped(solid, t);
    for (const SignOptions& sign : {kWinding, kAutomatic}) {
      const SignReport report = expect_sides(mesh, grid, sign, Convex(solid));
      EXPECT_EQ(report.flipped, 1);
      EXPECT_EQ(report.boundary_edges, 0);
      EXPECT_TRUE(report.sure);
    }
    const SignReport report = expect_sides(mesh, grid, kAsOriented, ByWinding(mesh, grid));
    EXPECT_EQ(report.flipped, 0);
    EXPECT_EQ(report.boundary_edges, 3);
  });
}

// The second copy adds its solid angle, which is positive within the solid and above -1/2 outside.
TEST(DamagedCases, OneTriangleTwice) {
  for_each_damage([](const Mesh& solid, std::size_t t, const Grid& grid) {
    for (const SignOptions& sign : {kWinding, kAutomatic, kAsOriented})
      expect_sides(with_copy(solid, t, false), grid, sign, Convex(solid));
  });
}

// The copy takes the triangle away: a hole, as above.
TEST(DamagedCases, OneTriangleTwiceInOppositeOrientations) {
  for_each_damage([](const Mesh& solid, std::size_t t, const Grid& grid) {
    for (const SignOptions& sign : {kWinding, kAutomatic, kAsOriented})
      expect_sides(with_copy(solid, t, true), grid, sign, Convex(solid));
  });
}

TEST(DamagedCases, ScansWithHoles) {
  const Mesh ball = sphere(10);
  const Grid grid = grid_around(ball, 15);
  for (const double share : {0.01, 0.1, 0.4})
    for (unsigned seed = 0; seed < 2; ++seed) {
      SCOPED_TRACE(std::to_string(share) + " " + std::to_string(seed));
      const Mesh mesh = with_holes(ball, share, seed);
      const ByWinding known(mesh, grid);
      const SignReport report = expect_sides(mesh, grid, kWinding, known);
      EXPECT_GT(report.boundary_edges, 0);
      EXPECT_EQ(report.flipped, 0);
      if (share < 0.2) expect_sides(mesh, grid, kAutomatic, known);
    }
}

// Large regions are decided as one.
TEST(DamagedCases, HolesInFineGrids) {
  const Mesh ball = sphere(9);
  for (const Mesh& mesh : {with_holes(ball, 0.05, 1), with_holes(ball, 0.5, 2), cut_off(ball, 0.2)}) {
    const Grid grid = grid_around(mesh, 60, 0.6);
    expect_sides(mesh, grid, kAsOriented, ByWinding(mesh, grid, WindingRule::positive, 97), 0.1);
  }
}

// Half of a ball's triangles are missing, so the winding number is about 1/2 wherever one is inside: hundreds of holes,
// none of which matters alone, decide every sample.
TEST(DamagedCases, HalfOfAllTrianglesMissing) {
  const Mesh mesh = with_holes(sphere(16), 0.5, 7);
  const Grid grid = grid_around(mesh, 22);
  expect_sides(mesh, grid, kAsOriented, ByWinding(mesh, grid, WindingRule::positive, 9), 0.1);
}

TEST(DamagedCases, OneBigHole) {
  const Mesh ball = sphere(10);
  for (const double z : {0.6, 0.33, 0.0, -0.5}) {
    const Mesh mesh = cut_off(ball, z);
    const Grid grid = grid_around(ball, 14);
    const ByWinding positive(mesh, grid), nonzero(mesh, grid, WindingRule::nonzero);
    expect_sides(mesh, grid, kWinding, positive);
    expect_sides(mesh, grid, kAsOriented, positive);
    expect_sides(mesh, grid, {.method = SignMethod::winding, .rule = WindingRule::nonzero}, nonzero);
    // If all looks the other way, all is flipped: what is left is more body than sheet. Of half a ball that is open.
    if (z <= 0) continue;
    EXPECT_EQ(expect_sides(reversed(mesh), grid, kWinding, positive).flipped, std::ssize(mesh.triangles));
  }
}

TEST(DamagedCases, HolesAndFlipsAtOnce) {
  const Mesh ball = sphere(12);
  const Mesh holes = with_holes(ball, 0.03, 5);
  std::int64_t turned = 0;
  const Mesh mesh = randomly_turned(holes, 6, turned, 0.3);
  const Grid grid = grid_around(ball, 17);
  const SignReport report = expect_sides(mesh, grid, kWinding, ByWinding(holes, grid));
  EXPECT_EQ(report.flipped, turned);
}

// Vertices within edges of neighbours: the gaps have no width, or that of rounding.
TEST(DamagedCases, PartsWithTJunctions) {
  Mesh mesh;
  std::vector<Convex> known;
  for (int n = 0; n < 5; ++n) {
    const Vec3 low{0.7 * n, 0.1 * n * n, 0}, high = low + Vec3{1.0 / 3, 1.1, 0.3 + 0.2 * n};
    mesh = joined(std::move(mesh), box_of_t_junctions(low, high, 3));
    known.emplace_back(box(low, high));
  }
  const auto in_parts = [&](Vec3 p) { return in_any(known, p); };
  const Grid grid = grid_around(mesh, 16);
  for (const SignOptions& sign : {kWinding, kAutomatic, kAsOriented}) {
    const SignReport report = expect_sides(mesh, grid, sign, in_parts);
    EXPECT_EQ(report.method, SignMethod::winding);
    EXPECT_EQ(report.flipped, 0) << "parts were oriented";
  }
}

// No triangle shares an exact position with its neighbours, so nothing can be propagated; all look outwards already.
TEST(DamagedCases, PartsWithCracksBetweenAllTriangles) {
  Mesh whole;
  std::vector<Convex> known;
  for (int n = 0; n < 4; ++n) {
    const Vec3 at{1.9 * n, 0.3 * n, -0.2 * n};
    const Mesh one = n % 2 == 0 ? moved(sphere(6), at, 0.9) : moved(box({-0.8, -0.8, -0.8}, {0.8, 0.8, 0.8}), at);
    whole = joined(std::move(whole), one);
    known.emplace_back(one, 1e-5);
  }
  const auto in_parts = [&](Vec3 p) { return in_any(known, p); };
  const Grid grid = grid_around(whole, 14);
  for (const Mesh& mesh : {cracked_floats(whole, 1), cracked(whole, 1e-15, 2), cracked(whole, 1e-6, 3)})
    for (const SignOptions& sign : {kAsOriented, kWinding, kAutomatic}) {
      const SignReport report = expect_sides(mesh, grid, sign, in_parts);
      EXPECT_EQ(report.flipped, 0) << "all looked outwards";
    }
}

TEST(DamagedCases, TrianglesWithoutArea) {
  const Mesh ball = sphere(7);
  const Mesh mesh = with_degenerate(ball, 1, 200);
  for (const SignOptions& sign : {kWinding, kAutomatic, kAsOriented, SignOptions{.method = SignMethod::parity}}) {
    const SignReport report = expect_sides(mesh, grid_around(ball, 17), sign, Convex(ball));
    EXPECT_EQ(report.boundary_edges, 0);
    EXPECT_EQ(report.flipped, 0);
  }
}

TEST(DamagedCases, Needles) {
  for (const double height : {0.0, 1e-12, 1e-7}) {
    SCOPED_TRACE(height);
    for (const Mesh& solid : {sphere(6), box({-1e-3, -1e-3, -40}, {1e-3, 1e-3, 50})}) {
      const Box extent = bounds(solid);
      const Vec3 step = extent.extent() * (1 / 13.37);
      const Grid grid{{18, 18, 18}, extent.min - step * 1.9, step};  // needs all decimals of the thin sides
      for (const SignOptions& sign : {kWinding, kAutomatic})
        expect_sides(with_needles(solid, height), grid, sign, Convex(solid, 1e-12));
    }
  }
}

}  // namespace
}  // namespace standoff
