// SPDX-License-Identifier: Apache-2.0
// Surface voxels against integers that tell overlaps exactly: corners, edges and faces that only touch, triangles
// without area, stretched and distant grids.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "scenes/scenes.h"
#include "standoff/voxels.h"
#include "tests/sign/shapes.h"
#include "tests/support/expect_error.h"
#include "tests/support/random_mesh.h"

namespace standoff {
namespace {

using testing::Random;
using Whole = std::array<std::int64_t, 3>;

Whole minus(const Whole& a, const Whole& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Whole cross_of(const Whole& a, const Whole& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
std::int64_t dot_of(const Whole& a, const Whole& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

// Whether a triangle meets a closed box, in integers: separating axes, all of them.
bool meet(const std::array<Whole, 3>& t, const Whole& center, const Whole& half) {
  const std::array<Whole, 3> v{minus(t[0], center), minus(t[1], center), minus(t[2], center)};
  const std::array<Whole, 3> edges{minus(t[1], t[0]), minus(t[2], t[1]), minus(t[0], t[2])};
  const std::array<Whole, 3> units{Whole{1, 0, 0}, Whole{0, 1, 0}, Whole{0, 0, 1}};
  std::vector<Whole> axes(units.begin(), units.end());
  const Whole normal = cross_of(edges[0], edges[1]);
  axes.push_back(normal);
  for (const Whole& edge : edges) {
    for (const Whole& unit : units) axes.push_back(cross_of(unit, edge));
    axes.push_back(cross_of(normal, edge));  // tells triangles without a volume beside them apart, too
  }
  return std::ranges::none_of(axes, [&](const Whole& axis) {
    std::int64_t bound = 0;
    for (std::size_t k = 0; k < 3; ++k) bound += std::abs(axis[k]) * half[k];
    const auto [low, high] = std::minmax({dot_of(axis, v[0]), dot_of(axis, v[1]), dot_of(axis, v[2])});
    return low > bound || high < -bound;
  });
}

Occupancy brute_force(const std::vector<std::array<Whole, 3>>& triangles, const Grid& grid, const Whole& first,
                      const Whole& half) {
  Occupancy voxels{grid, {}, {}};
  voxels.bits.resize(static_cast<std::size_t>(voxels.row_bytes() * grid.size.y * grid.size.z));
  for (std::int64_t k = 0; k < grid.size.z; ++k)
    for (std::int64_t j = 0; j < grid.size.y; ++j)
      for (std::int64_t i = 0; i < grid.size.x; ++i) {
        const Whole center{first[0] + 2 * half[0] * i, first[1] + 2 * half[1] * j, first[2] + 2 * half[2] * k};
        if (std::ranges::any_of(triangles, [&](const auto& t) { return meet(t, center, half); }))
          voxels.bits[static_cast<std::size_t>((k * grid.size.y + j) * voxels.row_bytes() + i / 8)] |=
              static_cast<std::uint8_t>(1 << (i % 8));
      }
  return voxels;
}

Mesh mesh_of(const std::vector<std::array<Whole, 3>>& triangles, double scale, const Vec3& shift) {
  Mesh mesh;
  for (const auto& t : triangles) {
    const auto at = [&](std::size_t n) {
      return Vec3{double(t[n][0]), double(t[n][1]), double(t[n][2])} * scale + shift;
    };
    testing::add_triangle(mesh, at(0), at(1), at(2));
  }
  return mesh;
}

// Integer corners: many lie on faces, edges and corners of voxels, many triangles are flat. All is exact, so no voxel
// is added by rounding.
TEST(SurfaceVoxels, AsIntegersTell) {
  const Whole half{2, 3, 1}, first{-20, -21, -9};
  std::int64_t marked = 0;
  for (unsigned seed = 0; seed < 40; ++seed) {
    Random random(seed);
    std::vector<std::array<Whole, 3>> triangles(6);
    for (auto& t : triangles)
      for (Whole& corner : t)
        for (std::int64_t& c : corner) c = std::int64_t(random.below(45)) - 22;
    triangles[0][2] = triangles[0][1];                                   // a segment
    triangles[1] = {triangles[1][0], triangles[1][0], triangles[1][0]};  // a point
    for (const double scale : {1.0, 0x1p-60, 0x1p90}) {
      const Vec3 shift = scale == 1 ? Vec3{0x1p40, -0x1p38, 0x1p41} : Vec3{};
      const Grid grid{{11, 8, 10},
                      Vec3{double(first[0]), double(first[1]), double(first[2])} * scale + shift,
                      Vec3{4, 6, 2} * scale};
      const Occupancy voxels = surface_voxels(mesh_of(triangles, scale, shift), grid);
      EXPECT_EQ(voxels.bits, brute_force(triangles, grid, first, half).bits) << seed;
      marked += voxels.count();
    }
  }
  EXPECT_GT(marked, 5000);
}

// Long thin triangles, all over the grid: none is missed along a dense set of their points.
TEST(SurfaceVoxels, HoldEveryPointOfTheSurface) {
  const Mesh mesh = testing::nasty_soup(7, 120, 2);
  const Grid grid{{41, 37, 43}, {-2, -1.9, -2.1}, {0.1, 0.103, 0.098}};
  const Occupancy voxels = surface_voxels(mesh, grid);
  Random random(3);
  std::int64_t points = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (int n = 0; n < 400; ++n) {
      const auto c = MeshView(mesh).corners(t);
      double u = random.below(1001) / 1000.0, v = random.below(1001) / 1000.0;
      if (u + v > 1) u = 1 - u, v = 1 - v;
      const Vec3 at = (c[0] * (1 - u - v) + c[1] * u + c[2] * v - grid.origin) / grid.spacing;
      const double x = std::round(at.x), y = std::round(at.y), z = std::round(at.z);
      if (x < 0 || y < 0 || z < 0 || x >= 41 || y >= 37 || z >= 43) continue;
      ++points;
      EXPECT_TRUE(voxels.inside(std::int64_t(x), std::int64_t(y), std::int64_t(z))) << t;
    }
  EXPECT_GT(points, 10000);
  EXPECT_LT(voxels.count(), 30000);
}

TEST(SurfaceVoxels, OfABox) {
  // Faces in the middle of voxels: a shell one voxel thick. Faces between voxels: both touch.
  const Mesh box = testing::box({0, 0, 0}, {4, 4, 4});
  EXPECT_EQ(surface_voxels(box, {{9, 9, 9}, {-2, -2, -2}}).count(), 5 * 5 * 5 - 3 * 3 * 3);
  EXPECT_EQ(surface_voxels(box, {{10, 10, 10}, {-2.5, -2.5, -2.5}}).count(), 6 * 6 * 6 - 2 * 2 * 2);
  EXPECT_EQ(surface_voxels(box, {{1, 1, 1}, {2, 2, 2}}).count(), 0);
  EXPECT_EQ(surface_voxels(box, {{1, 1, 1}, {2, 2, 2}, {4, 4, 4}}).count(), 1);  // its faces touch from outside
}

TEST(SurfaceVoxels, UnitedWithSolidOnes) {
  const Mesh mesh = scenes::make("sphere", 2000);
  const Grid grid = fit_resolution(bounds(mesh), 41);
  const Occupancy solid = occupancy(mesh, grid), surface = surface_voxels(mesh, grid);
  Occupancy both = solid;
  add_voxels(both, surface);
  std::int64_t count = 0;
  for (std::int64_t k = 0; k < grid.size.z; ++k)
    for (std::int64_t j = 0; j < grid.size.y; ++j)
      for (std::int64_t i = 0; i < grid.size.x; ++i) count += solid.inside(i, j, k) || surface.inside(i, j, k);
  EXPECT_EQ(both.count(), count);
  EXPECT_GT(count, solid.count());
  EXPECT_GT(count, surface.count());
  // Nothing is left between them: a voxel beside a solid one is solid or on the surface.
  std::int64_t beside = 0;
  for (std::int64_t k = 1; k < grid.size.z; ++k)
    for (std::int64_t i = 1; i < grid.size.x; ++i)
      if (solid.inside(i, 20, k) != solid.inside(i - 1, 20, k))
        beside += surface.inside(i, 20, k) || surface.inside(i - 1, 20, k) ? 0 : 1;
  EXPECT_EQ(beside, 0);
}

TEST(SurfaceVoxels, SameForAnyThreads) {
  const Mesh mesh = scenes::make("sphere", 5000);
  const Grid grid = fit_resolution(bounds(mesh), 80);
  EXPECT_EQ(surface_voxels(mesh, grid, {.execution = {.threads = 1}}).bits,
            surface_voxels(mesh, grid, {.execution = {.threads = 5}}).bits);
}

TEST(SurfaceVoxels, Errors) {
  const Mesh box = testing::box();
  const Grid grid{{9, 9, 9}, {-1, -1, -1}, {0.4, 0.4, 0.4}};
  expect_error([&] { surface_voxels(testing::box({0, 0, 0}, {1e101, 1, 1}), grid); }, ErrorCode::limit, "scale them");
  expect_error([&] { surface_voxels(box, grid, {.progress = [](const Progress&) { return false; }}); },
               ErrorCode::interrupted, "cancelled");
  Occupancy one = surface_voxels(box, grid);
  const Occupancy other = surface_voxels(box, {{9, 9, 8}, {-1, -1, -1}, {0.4, 0.4, 0.4}});
  expect_error([&] { add_voxels(one, other); }, ErrorCode::usage, "the same grid");
  expect_error([&] { write_voxels("a.stl", one); }, ErrorCode::usage, ".binvox");
  one.bits.pop_back();
  expect_error([&] { write_voxels("a.npz", one); }, ErrorCode::usage, "not those of the grid");
  expect_error(
      [&] {
        write_voxels("a.binvox", surface_voxels(box, {{9, 9, 9}, {}, {0.4, 0.4, 0.5}}));
      },
      ErrorCode::usage, "holds cubes");
}

}  // namespace
}  // namespace standoff
