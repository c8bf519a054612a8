// SPDX-License-Identifier: Apache-2.0
// The method tiles against the distance by definition.
// labels: memory
#include <gtest/gtest.h>

#include "tests/support/fields.h"
#include "tests/support/random_mesh.h"

namespace standoff::testing {
namespace {

// Thicknesses in spacings: up to four, triangles are binned into bricks; beyond, as counts say (cpu/band_choice.h).
void expect_exact_at_all_thicknesses(const Mesh& mesh, const Grid& grid) {
  expect_exact(mesh, grid, {0.5, 2, 3.9, 4.1, 8, kInfinity});
}

const Grid kCube{{20, 20, 20}, {-4.75, -4.75, -4.75}, {0.5, 0.5, 0.5}};

TEST(TilesExact, TrianglesFromTinyToHuge) {
  // Lengths in spacings: up to 16, a triangle is set up in float; beyond, in double.
  for (const double side : {1e-4, 0.1, 1.0, 5.0, 7.9, 16.0, 100.0}) {
    SCOPED_TRACE(side);
    expect_exact_at_all_thicknesses(random_soup(11, 24, 4.5, side * 0.5), kCube);
  }
}

TEST(TilesExact, GridsOfAllShapes) {
  const Mesh mesh = random_soup(12, 24, 5, 1);
  const Grid grids[] = {{{1, 1, 1}, {0.3, 0.2, 0.1}, {1, 1, 1}},       {{1, 17, 33}, {0.1, -4, -8}, {0.5, 0.5, 0.5}},
                        {{41, 1, 9}, {-5, 0.2, -2}, {0.25, 1, 0.5}},   {{9, 23, 1}, {-5, -5, 0.1}, {1.1, 0.4, 7}},
                        {{16, 16, 16}, {-4, -4, -4}, {0.5, 0.5, 0.5}}, {{17, 8, 24}, {-4, -2, -6}, {0.5, 0.5, 0.5}}};
  for (const Grid& grid : grids) {
    SCOPED_TRACE(::testing::Message() << grid.size.x << 'x' << grid.size.y << 'x' << grid.size.z);
    expect_exact_at_all_thicknesses(mesh, grid);
  }
}

TEST(TilesExact, AnisotropicSpacings) {
  const Mesh mesh = random_soup(13, 24, 5, 1.5);
  expect_exact_at_all_thicknesses(mesh, {{33, 5, 37}, {-5, -6, -5}, {0.3, 3, 0.09}});
  expect_exact_at_all_thicknesses(mesh, {{5, 37, 33}, {-6, -5, -5}, {3, 0.09, 0.3}});
}

TEST(TilesExact, MeshesPartlyOrWhollyOutsideTheGrid) {
  expect_exact_at_all_thicknesses(random_soup(14, 24, 5, 1, {5, 5, 0}), kCube);
  for (const Vec3 away : {Vec3{9, 0, 0}, Vec3{-30, 40, 10}, Vec3{0, 0, -5000}})
    expect_exact_at_all_thicknesses(random_soup(15, 24, 2, 1, away), kCube);
}

TEST(TilesExact, MeshesMillionsOfSpacingsAway) {
  expect_exact(random_soup(16, 12, 100, 30, {3e7, -2e7, 1e6}), kCube, {kInfinity});
  // One part near, one far: neither may spoil the other.
  Mesh mesh = random_soup(17, 12, 4, 1);
  add_triangle(mesh, {4e7, 4e7, 4e7}, {4e7, 5e7, 4e7}, {5e7, 4e7, 4e7});
  expect_exact_at_all_thicknesses(mesh, kCube);
}

TEST(TilesExact, DegenerateAndRepeatedTriangles) {
  expect_exact_at_all_thicknesses(nasty_soup(18, 40, 5), kCube);
  const Grid coarse{{13, 13, 13}, {-6, -6, -6}, {1, 1, 1}};  // corners fall on samples
  expect_exact_at_all_thicknesses(nasty_soup(19, 40, 5), coarse);
}

TEST(TilesExact, ManySmallDegenerateTrianglesOnSamples) {
  Random random(50);
  Mesh mesh;
  for (int n = 0; n < 600; ++n) {
    const Vec3 at = random.in_cube(9);
    const auto corner = [&] {
      const Vec3 v = at + random.in_cube(0.6);
      return Vec3{std::round(v.x), std::round(v.y), std::round(v.z)};
    };
    const Vec3 a = corner(), b = corner(), c = corner();
    add_triangle(mesh, a, b, c);
  }
  expect_exact_at_all_thicknesses(mesh, {{19, 19, 19}, {-9, -9, -9}, {1, 1, 1}});
}

TEST(TilesExact, Slivers) {
  Random random(20);
  for (const double length : {3.0, 12.0, 200.0}) {
    Mesh mesh;
    for (int n = 0; n < 24; ++n) {
      const Vec3 a = random.in_cube(4), b = a + random.in_cube(length);
      const double width = std::pow(10, -random.between(1, 12));
      add_triangle(mesh, a, b, a + (b - a) * random.between(0, 1) + random.in_cube(width));
    }
    expect_exact_at_all_thicknesses(mesh, kCube);
  }
}

TEST(TilesExact, OneTriangleThatCoversEverything) {
  for (const double size : {1.0, 1e3, 1e6}) {
    SCOPED_TRACE(size);
    Mesh mesh;
    add_triangle(mesh, Vec3{-900, -1000, -800} * size, Vec3{1100, -900, 700} * size, Vec3{100, 1200, 300} * size);
    // Its plane goes through the grid: moved there along z.
    const Vec3 a = mesh.vertices[0], ab = mesh.vertices[1] - a, ac = mesh.vertices[2] - a, n = cross(ab, ac);
    const double z = dot(n, a) / n.z;
    for (Vec3& v : mesh.vertices) v.z -= z - 0.3;
    expect_exact_at_all_thicknesses(mesh, kCube);
  }
}

TEST(TilesExact, FarFromTheOrigin) {
  for (const Vec3 far : {Vec3{1e6, -1e6, 1e6}, Vec3{-3e8, 0, 2e8}}) {
    Grid grid = kCube;
    grid.origin = grid.origin + far;
    expect_exact_at_all_thicknesses(random_soup(21, 24, 5, 1, far), grid);
  }
}

TEST(TilesExact, TinyAndHugeScales) {
  for (const double scale : {1e-6, 1.7e-12, 3e-25, 1e12, 7e20}) {
    SCOPED_TRACE(scale);
    Mesh mesh = random_soup(22, 24, 5, 1);
    for (Vec3& v : mesh.vertices) v = v * scale;
    Grid grid = kCube;
    grid.origin = grid.origin * scale;
    grid.spacing = grid.spacing * scale;
    expect_exact_at_all_thicknesses(mesh, grid);
  }
}

TEST(TilesExact, SpacingsJustAboveAPowerOfTwo) {
  // Triangles of sixteen spacings, set up in float, as far from their bricks as the allowed error permits.
  for (const double spacing : {1.0, 1.999}) {
    const Grid grid{{17, 17, 17}, {-8, -8, -8}, {spacing, spacing, spacing}};
    for (const unsigned seed : {23u, 24u, 25u}) expect_exact(random_soup(seed, 24, 10, 7.9), grid, {3.9, 12});
  }
}

TEST(TilesExact, SeveralBricksAndManyTriangles) {
  // More candidates than one table of 2048 holds: small ones, which cells cull by boxes first, and larger ones.
  const Grid grid{{3, 3, 3}, {-5, -5, -5}, {5, 5, 5}};
  expect_exact(random_soup(26, 9000, 0.02, 0.01), grid, {kInfinity});
  expect_exact(random_soup(30, 4000, 8, 7.5), grid, {kInfinity});
  expect_exact(random_soup(27, 300, 12, 0.7), {{37, 10, 33}, {-12, -3, -10}, {0.7, 0.7, 0.7}}, {4, kInfinity});
}

TEST(TilesExact, PortableKernels) {
  expect_exact(random_soup(28, 10, 2, 1), {{9, 9, 9}, {-2, -2, -2}, {0.5, 0.5, 0.5}}, {2}, Simd::portable);
  expect_exact(nasty_soup(29, 10, 3), {{9, 9, 9}, {-2, -2, -2}, {0.5, 0.5, 0.5}}, {kInfinity}, Simd::portable);
}

}  // namespace
}  // namespace standoff::testing
