// SPDX-License-Identifier: Apache-2.0
// Crossings held in parts, as little memory makes them, are those held all at once; and what is held is no more than
// was said.
#include "sign/rows/row_crossings.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <vector>

#include "core/threads.h"
#include "sign/rows/changed_crossings.h"
#include "tests/sign/solid_soup.h"
#include "tests/support/heap.h"

namespace standoff {
namespace {

using testing::Random;
using testing::Tetrahedron;

// The bytes of all tiles, and how many parts they came in.
struct Inside {
  std::vector<std::uint8_t> bytes;
  int parts = 0;
};
Inside inside_of(const Mesh& mesh, const Grid& grid, WindingRule rule, std::int64_t bytes) {
  const ProgressCallback none;
  ProgressMeter progress(none);
  IntegerWinding winding({mesh}, grid, rule, progress, bytes);
  InsideRows rows(grid);
  Inside inside;
  const std::int64_t tiles_y = (grid.size.y + 7) / 8, all = tiles_y * ((grid.size.z + 7) / 8);
  for (std::int64_t first = 0, end = 0; first < all; first = end, ++inside.parts) {
    end = winding.load(first);
    EXPECT_GT(end, first);
    for (std::int64_t n = first; n < end; ++n) {
      rows.clear(n % tiles_y, n / tiles_y);
      winding.fill(rows, n % tiles_y, n / tiles_y);
      for (std::int64_t tx = 0; tx < (grid.size.x + 7) / 8; ++tx) {
        const auto tile = std::as_const(rows).tile(tx);
        inside.bytes.insert(inside.bytes.end(), tile.begin(), tile.end());
      }
    }
  }
  return inside;
}

constexpr std::int64_t kEnough = std::int64_t{1} << 40;

// Crossings that are kept say what they take, also after the mesh moved. Where they are too many, the search ends
// early.
TEST(RowCrossings, KeptOnesCountWhatTheyTake) {
  Random random(1);
  std::vector<Tetrahedron> solids;
  for (int n = 0; n < 40; ++n)
    solids.push_back({random.in_cube(3), random.in_cube(3), random.in_cube(3), random.in_cube(3)});
  const Mesh before = testing::mesh_of(solids);
  Mesh after = before;
  for (Vec3& v : after.vertices) v = v * 0.7;
  const Grid grid{{50, 130, 121}, {-3, -3, -3}, {0.12, 0.047, 0.05}};
  ProgressMeter progress;
  Threads(2).run([&] {
    KeptCrossings kept({before}, grid, WindingRule::nonzero, progress, kEnough);
    const auto bytes = static_cast<double>(kept.bytes());
    EXPECT_NEAR(bytes, KeptCrossings::expected_bytes({before}, grid), bytes / 10);
    kept.follow(ChangedCrossings({before}, {after}, grid, progress));
    const KeptCrossings anew({after}, grid, WindingRule::nonzero, progress, kEnough);
    EXPECT_EQ(kept.bytes(), anew.bytes());
    EXPECT_LT(static_cast<double>(kept.bytes()), 0.7 * bytes);
    const std::int64_t half = anew.bytes() / 2;
    const KeptCrossings some({after}, grid, WindingRule::nonzero, progress, half);
    EXPECT_GT(some.bytes(), half);
    EXPECT_LT(some.bytes(), anew.bytes());
  });
}

TEST(RowCrossings, PartsOfTheGrid) {
  Random random(1);
  std::vector<Tetrahedron> solids;
  for (int n = 0; n < 40; ++n)
    solids.push_back({random.in_cube(3), random.in_cube(3), random.in_cube(3), random.in_cube(3)});
  const Mesh mesh = testing::mesh_of(solids);
  const Grid grid{{50, 130, 121}, {-3, -3, -3}, {0.12, 0.047, 0.05}};
  const Inside all = inside_of(mesh, grid, WindingRule::nonzero, kEnough);
  EXPECT_EQ(all.parts, 1);
  for (const int threads : {1, 3}) {
    const Inside parts = Threads(threads).run([&] { return inside_of(mesh, grid, WindingRule::nonzero, 0); });
    EXPECT_GT(parts.parts, 3);
    EXPECT_EQ(parts.bytes, all.bytes) << threads << " threads";
  }
}

// Thousands of shells: the crossings of one row of tiles are more than fit, so its rows come one by one. Some shells
// are there twice, and cancel or add up.
TEST(RowCrossings, RowByRow) {
  std::vector<Tetrahedron> nested;
  for (int n = 1; n <= 1500; ++n) {
    const double s = 2 * n;
    const Tetrahedron t{Vec3{-s, -s, -s}, Vec3{3 * s, -s, -s}, Vec3{-s, 3 * s, -s}, Vec3{-s, -s, 3 * s}};
    nested.push_back(n % 3 != 0 ? t : Tetrahedron{t[1], t[0], t[2], t[3]});
    if (n % 5 == 0) nested.push_back(t);
  }
  const Mesh mesh = testing::mesh_of(nested);
  const Grid grid{{300, 10, 11}, {-3100.5, -200.5, -100.5}, {20.3, 21, 19}};
  for (const WindingRule rule : {WindingRule::positive, WindingRule::odd}) {
    const Inside all = inside_of(mesh, grid, rule, kEnough);
    const Inside rows = Threads(2).run([&] { return inside_of(mesh, grid, rule, 0); });
    EXPECT_EQ(rows.parts, 4);
    EXPECT_EQ(rows.bytes, all.bytes);
  }
}

// More steps at a sample than one entry holds.
TEST(RowCrossings, ManySheetsInOnePlace) {
  Mesh mesh{{{0, -9, -9}, {0, 9, -9}, {0, 0, 9}, {5, -9, -9}, {5, 9, -9}, {5, 0, 9}}, {}};
  constexpr int kSheets = 140'000;
  for (int n = 0; n < kSheets; ++n) {
    mesh.triangles.push_back({0, 2, 1});
    mesh.triangles.push_back({3, 4, 5});
  }
  const Grid grid{{16, 2, 2}, {-2.5, -0.1, -0.1}, {1, 0.1, 0.1}};
  const ProgressCallback none;
  ProgressMeter progress(none);
  RowCrossings crossings({mesh}, grid, progress, 0);
  EXPECT_EQ(crossings.load(0), 1);
  EXPECT_LT(crossings.of_tiles(0, 0).size(), 4u * 2 * (kSheets / RowCrossing::kMostSteps + 1) + 1);
  std::int32_t winding = 0, deepest = 0;
  for (const RowCrossing& one : crossings.of_tiles(0, 0)) {
    EXPECT_TRUE(one.past() == 3 || one.past() == 8) << one.past();
    deepest = std::max(deepest, winding += one.step());
  }
  EXPECT_EQ(deepest, kSheets);
  EXPECT_EQ(winding, 0);
}

TEST(RowCrossings, HoldNoMoreThanWasSaid) {
  Random random(2);
  std::vector<Tetrahedron> solids;
  for (int n = 0; n < 700; ++n)
    solids.push_back({random.in_cube(3), random.in_cube(3), random.in_cube(3), random.in_cube(3)});
  const Mesh mesh = testing::mesh_of(solids);
  const std::int64_t triangles = std::ssize(mesh.triangles);
  for (const Grid& grid :
       {Grid{{50, 60, 70}, {-3, -3, -3}, {0.12, 0.1, 0.09}}, Grid{{3000, 9, 9}, {-3, -3, -3}, {0.002, 0.7, 0.7}}})
    for (const int threads : {1, 4})
      for (const std::int64_t bytes : {std::int64_t{0}, std::int64_t{1} << 20, std::int64_t{40} << 20}) {
        const std::int64_t most = std::max(bytes, RowCrossings::least_bytes(triangles, threads)) +
                                  RowCrossings::other_bytes(triangles, grid, threads);
        constexpr std::int64_t kSmallThings = 64 << 10;  // of TBB
        const std::int64_t taken = testing::heap::most_held([&] {
          Threads(threads).run([&] {
            const ProgressCallback none;
            ProgressMeter progress(none);
            RowCrossings crossings({mesh}, grid, progress, bytes);
            const std::int64_t all = (grid.size.y + 7) / 8 * ((grid.size.z + 7) / 8);
            for (std::int64_t first = 0; first < all;) first = crossings.load(first);
          });
        });
        EXPECT_LE(taken, most + kSmallThings) << grid.size.x << ", " << threads << " threads, " << bytes;
      }
}

}  // namespace
}  // namespace standoff
