// SPDX-License-Identifier: Apache-2.0
// The scan's single precision never decides what it cannot: crossings of triangles of all kinds against exact
// predicates, row by row, for the kernels of each instruction set.
#include "sign/rows/row_scan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "sign/rows/ray_crossing.h"
#include "sign/signs.h"
#include "simd/dispatch.h"
#include "tests/support/random_mesh.h"

namespace standoff {
namespace {

using testing::Random;

// A crossing of row (j, k): its number, the first sample past it, whether the solid is entered.
using Crossings = std::vector<std::array<std::int64_t, 4>>;

// By exact predicates alone, of every row and by bisection along it.
Crossings exact_crossings(const OrientedMesh& mesh, const Grid& grid, const RowWindow& window) {
  Crossings all;
  for (std::size_t n = 0; n < mesh.mesh.triangles.size(); ++n) {
    if (mesh.use_of(n) == 0) continue;
    const RayTriangle triangle(mesh.corners(n));
    for (std::int64_t k = window.begin[1]; k < window.end[1]; ++k)
      for (std::int64_t j = window.begin[0]; j < window.end[0]; ++j) {
        const Vec3 row = grid.position(0, j, k);
        const int crossing = triangle.crossing(row.y, row.z);
        if (crossing == 0) continue;
        std::int64_t before = -1, past = grid.size.x;
        while (past - before > 1) {
          const std::int64_t i = (before + past) / 2;
          (triangle.is_past(grid.position(i, j, k), crossing) ? past : before) = i;
        }
        if (past < grid.size.x) all.push_back({j, k, past, crossing < 0});
      }
  }
  std::ranges::sort(all);
  return all;
}

Crossings scanned_crossings(const OrientedMesh& mesh, const Grid& grid, const RowWindow& window, Simd simd) {
  BlockBudget budget(std::int64_t{1} << 40);
  CrossingList list(budget);
  EXPECT_TRUE(RowScan(mesh, grid, simd).scan(0, mesh.mesh.triangles.size(), window, list));
  Crossings all;
  const std::int64_t tiles_y = (grid.size.y + 7) / 8, first = window.begin[0] / 8 + tiles_y * (window.begin[1] / 8);
  list.for_each_block([&](std::span<const FoundCrossing> block) {
    for (const FoundCrossing& one : block) {
      const auto tiles = static_cast<std::int64_t>(one.row() / 64) + first,
                 row = static_cast<std::int64_t>(one.row() % 64);
      all.push_back({8 * (tiles % tiles_y) + row % 8, 8 * (tiles / tiles_y) + row / 8,
                     static_cast<std::int64_t>(one.past()), one.enters()});
    }
  });
  std::ranges::sort(all);
  return all;
}

void expect_exact(const OrientedMesh& mesh, const Grid& grid, const RowWindow& window, const std::string& what) {
  const Crossings exact = exact_crossings(mesh, grid, window);
  for (const Simd simd : {Simd::automatic, Simd::avx512, Simd::avx2, Simd::portable})
    if (simd == Simd::automatic || processor_has(simd)) {
      EXPECT_EQ(scanned_crossings(mesh, grid, window, simd), exact) << what << ", set " << static_cast<int>(simd);
    }
}
RowWindow all_of(const Grid& grid) { return {{0, 0}, {grid.size.y, grid.size.z}}; }

const Grid kGrid{{40, 37, 45}, {-1.1, -1, -1.3}, {0.055, 0.06, 0.057}};

TEST(RowScan, TrianglesOfAllSizes) {
  for (const double size : {0.001, 0.03, 0.1, 0.3, 2.0, 50.0, 1e4, 1e7}) {
    const Mesh mesh = testing::random_soup(3, size < 1 ? 600 : 60, 1.2, size);
    expect_exact({mesh}, kGrid, all_of(kGrid), "size " + std::to_string(size));
  }
}

TEST(RowScan, Slivers) {
  Random random(4);
  for (const double width : {1e-2, 1e-5, 1e-9, 1e-16, 0.0}) {
    Mesh mesh;
    for (int n = 0; n < 100; ++n) {
      const Vec3 a = random.in_cube(1.5), b = random.in_cube(1.5), along = (b - a) * random.between(0, 1);
      testing::add_triangle(mesh, a, b, a + along + random.in_cube(1) * width);
    }
    expect_exact({mesh}, kGrid, all_of(kGrid), "width " + std::to_string(width));
  }
}

// Triangles that pass a sample, or have a side that passes a row, by less than single precision tells: 2^-32 to 2^-18
// of their size.
TEST(RowScan, RowsAndSamplesWithinRounding) {
  Random random(9);
  for (const double far : {0.0, 1e5, 3e9})
    for (const double size : {1.0, 4.0, 30.0, 300.0}) {
      const Grid grid{{30, 20, 20}, {far - 15, -far - 10, 2 * far - 10}, {1, 1.1, 0.9}};
      Mesh mesh;
      for (int n = 0; n < 300; ++n) {
        const Vec3 sample = grid.position(2 + random.below(26), 2 + random.below(16), 2 + random.below(16));
        const double by = size * std::ldexp(1.0, -18 - static_cast<int>(random.below(15)));
        const Vec3 at = sample + random.in_cube(by), a = at + random.in_cube(size), b = at + random.in_cube(size);
        const double u = random.between(0.2, 0.6), v = n % 2 == 0 ? random.between(0.1, 0.4) : 0;
        // at = u a + v b + (1 - u - v) c; where v is 0, it is on the side from a to c.
        testing::add_triangle(mesh, a, b, (at - a * u - b * v) * (1 / (1 - u - v)));
      }
      expect_exact({mesh}, grid, all_of(grid), "size " + std::to_string(size) + " at " + std::to_string(far));
    }
}

// Corners on samples, edges along rows, planes that hold rows.
TEST(RowScan, TrianglesOnTheSamples) {
  Random random(5);
  const Grid grid{{17, 18, 19}, {-8, -8, -8}};
  Mesh mesh;
  for (int n = 0; n < 400; ++n) {
    const auto corner = [&] {
      const auto coordinate = [&] { return double(random.below(13)) - 6; };
      return Vec3{coordinate(), coordinate(), coordinate()};
    };
    testing::add_triangle(mesh, corner(), corner(), corner());
  }
  expect_exact({mesh}, grid, all_of(grid), "integers");
}

// Where samples are 2^-24 to 1 of a spacing off the places that single precision takes them to be at.
TEST(RowScan, FarFromTheOrigin) {
  for (const double far : {1e6, 1e10, 1e13, 1e15}) {
    Mesh mesh = testing::random_soup(6, 200, 20, 6);
    for (Vec3& v : mesh.vertices) v = v + Vec3{far, -far, 2 * far};
    const Grid grid{{30, 30, 30}, {far - 15, -far - 15, 2 * far - 15}, {1, 1.25, 0.75}};
    expect_exact({mesh}, grid, all_of(grid), "at " + std::to_string(far));
  }
}

TEST(RowScan, WindowsAndUses) {
  const Mesh mesh = testing::random_soup(7, 300, 1.2, 0.7);
  std::vector<std::int8_t> use(mesh.triangles.size());
  for (std::size_t n = 0; n < use.size(); ++n) use[n] = static_cast<std::int8_t>(static_cast<int>(n % 3) - 1);
  for (const RowWindow& window :
       {RowWindow{{0, 8}, {37, 24}}, RowWindow{{16, 16}, {24, 24}}, RowWindow{{21, 19}, {22, 20}}})
    expect_exact({mesh, use}, kGrid, window, "window");
}

// So many samples that float has the number of each, and more.
TEST(RowScan, LongRows) {
  for (const std::int64_t samples : {(1 << 24) - 1, 1 << 24, 1 << 27}) {
    const Grid grid{{samples, 9, 10}, {0, 0, 0}, {1, 0.5, 0.5}};
    Mesh mesh = testing::random_soup(10, 300, 1, 3);
    for (std::size_t n = 0; n < mesh.vertices.size(); ++n) {
      Vec3& v = mesh.vertices[n];
      v = Vec3{static_cast<double>(n / 3 % 3) * static_cast<double>(samples) / 2, 2, 2} + v;
    }
    expect_exact({mesh}, grid, all_of(grid), std::to_string(samples) + " samples");
  }
}

// Floats with a stride: another way to read.
TEST(RowScan, OtherLayouts) {
  const Mesh mesh = testing::random_soup(8, 200, 1.2, 0.4);
  std::vector<float> floats;
  for (const Vec3& v : mesh.vertices)
    for (const double c : {v.x, v.y, v.z, 7.0}) floats.push_back(static_cast<float>(c));
  const MeshView view{{floats.data(), mesh.vertices.size(), 16}, mesh.triangles};
  expect_exact({view}, kGrid, all_of(kGrid), "floats");
}

}  // namespace
}  // namespace standoff
