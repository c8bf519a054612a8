// SPDX-License-Identifier: Apache-2.0
// The method tiles: what must hold between one field and another, or within one.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <span>
#include <vector>

#include "field/cpu/tiles.h"
#include "standoff/compute.h"
#include "tests/support/fields.h"
#include "tests/support/random_mesh.h"

namespace standoff::testing {
namespace {

const Grid kPropertyGrid{{32, 16, 48}, {-7.75, -3.75, -11.75}, {0.5, 0.5, 0.5}};
constexpr double kThicknesses[] = {1.7, 3.1, kInfinity};

template <class Change>
Mesh moved(Mesh mesh, Change change) {
  for (Vec3& v : mesh.vertices) v = change(v);
  return mesh;
}

// Corners on a lattice of 2^-20, so that translations and scales by powers of two are exact.
Mesh dyadic_soup(unsigned seed) {
  return moved(random_soup(seed, 60, 7, 1.5), [](Vec3 v) {
    return Vec3{std::round(v.x * 0x1p20), std::round(v.y * 0x1p20), std::round(v.z * 0x1p20)} * 0x1p-20;
  });
}

// `at` returns the sample of b that belongs to a sample of a.
template <class At>
void expect_near(const DistanceField& a, const DistanceField& b, At at) {
  for_each_sample(a.grid(), [&](auto i, auto j, auto k) {
    const Size3 there = at(i, j, k);
    const double expected = a.value(i, j, k);
    ASSERT_NEAR(b.value(there.x, there.y, there.z), expected, 2 * promised_error(a.grid(), expected));
  });
}
constexpr auto kSame = [](auto i, auto j, auto k) { return Size3{i, j, k}; };

TEST(TilesProperties, NeighbouringSamplesDifferByTheirDistanceAtMost) {
  const Grid grid{{31, 17, 40}, {-7, -4, -8}, {0.45, 0.5, 0.4}};
  for (const double thickness : kThicknesses) {
    const DistanceField field = computed(random_soup(31, 50, 7, 2), grid, thickness).field;
    for_each_sample(grid, [&](auto i, auto j, auto k) {
      const double here = field.value(i, j, k), rounding = 2 * promised_error(grid, here);
      if (i > 0) {
        ASSERT_LE(std::abs(here - field.value(i - 1, j, k)), grid.spacing.x + rounding);
      }
      if (j > 0) {
        ASSERT_LE(std::abs(here - field.value(i, j - 1, k)), grid.spacing.y + rounding);
      }
      if (k > 0) {
        ASSERT_LE(std::abs(here - field.value(i, j, k - 1)), grid.spacing.z + rounding);
      }
    });
  }
}

TEST(TilesProperties, TheOrderOfTrianglesDoesNotChangeABit) {
  Mesh mesh = nasty_soup(32, 60, 6);
  const Mesh soup = random_soup(33, 200, 7, 1);
  for (std::size_t t = 0; t < soup.triangles.size(); ++t)
    add_triangle(mesh, MeshView(soup).corner(t, 0), MeshView(soup).corner(t, 1), MeshView(soup).corner(t, 2));
  Mesh shuffled = mesh;
  Random random(34);
  for (std::size_t n = mesh.triangles.size(); n > 1; --n)
    std::swap(shuffled.triangles[n - 1], shuffled.triangles[random.below(static_cast<std::uint32_t>(n))]);
  for (const double thickness : kThicknesses) {
    const auto a = computed(mesh, kPropertyGrid, thickness).field.to_dense();
    const auto b = computed(shuffled, kPropertyGrid, thickness).field.to_dense();
    EXPECT_TRUE(bits_of(a) == bits_of(b)) << thickness;
  }
}

TEST(TilesProperties, TiesGoToTheLowestTriangle) {
  Mesh mesh = random_soup(35, 150, 7, 1);
  const std::size_t originals = mesh.triangles.size();
  for (int copy = 0; copy < 2; ++copy)
    for (std::size_t t = 0; t < originals; ++t) mesh.triangles.push_back(mesh.triangles[originals - 1 - t]);
  // Reverse the order of parts of the mesh, so that the first copies come last.
  std::swap_ranges(mesh.triangles.begin(), mesh.triangles.begin() + 75, mesh.triangles.begin() + 225);
  std::vector<std::uint32_t> first(mesh.triangles.size());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    first[t] =
        static_cast<std::uint32_t>(std::ranges::find(mesh.triangles, mesh.triangles[t]) - mesh.triangles.begin());
  for (const double thickness : kThicknesses)
    for (const std::uint32_t nearest : all_nearest(computed(mesh, kPropertyGrid, thickness).field))
      ASSERT_TRUE(nearest == kNoTriangle || nearest == first[nearest]) << nearest;
}

TEST(TilesProperties, TranslationBySpacingsDoesNotChangeABit) {
  const Mesh mesh = dyadic_soup(36);
  const Vec3 by = Vec3{1 << 20, -(1 << 19), 12345} * 0.5;
  Grid there = kPropertyGrid;
  there.origin = kPropertyGrid.origin + by;
  for (const double thickness : kThicknesses)
    expect_same_bits(computed(mesh, kPropertyGrid, thickness).field,
                     computed(moved(mesh, [&](Vec3 v) { return v + by; }), there, thickness).field);
}

TEST(TilesProperties, AGridMovedBySomeSamplesSeesTheSameValues) {
  const Mesh mesh = dyadic_soup(37);
  Grid there = kPropertyGrid;  // bricks and tiles begin elsewhere
  there.origin = kPropertyGrid.position(3, 5, 1);
  there.size = {20, 9, 30};
  for (const double thickness : kThicknesses)
    expect_near(computed(mesh, there, thickness).field, computed(mesh, kPropertyGrid, thickness).field,
                [](auto i, auto j, auto k) {
                  return Size3{i + 3, j + 5, k + 1};
                });
}

TEST(TilesProperties, MirrorsAndTurnedAxes) {
  const Mesh mesh = dyadic_soup(38);
  Grid mirrored = kPropertyGrid;
  mirrored.origin.x = -kPropertyGrid.bounds().max.x;
  const Mesh mirror_mesh = moved(mesh, [](Vec3 v) { return Vec3{-v.x, v.y, v.z}; });
  const Grid turned{{kPropertyGrid.size.y, kPropertyGrid.size.z, kPropertyGrid.size.x},
                    {kPropertyGrid.origin.y, kPropertyGrid.origin.z, kPropertyGrid.origin.x},
                    kPropertyGrid.spacing};
  const Mesh turned_mesh = moved(mesh, [](Vec3 v) { return Vec3{v.y, v.z, v.x}; });
  for (const double thickness : kThicknesses) {
    const DistanceField field = computed(mesh, kPropertyGrid, thickness).field;
    expect_near(field, computed(mirror_mesh, mirrored, thickness).field, [](auto i, auto j, auto k) {
      return Size3{kPropertyGrid.size.x - 1 - i, j, k};
    });
    expect_near(field, computed(turned_mesh, turned, thickness).field, [](auto i, auto j, auto k) {
      return Size3{j, k, i};
    });
  }
}

TEST(TilesProperties, PowersOfTwoScaleExactly) {
  const Mesh mesh = dyadic_soup(39);
  for (const double scale : {0x1p-30, 2.0, 0x1p40}) {
    const Grid grid{kPropertyGrid.size, kPropertyGrid.origin * scale, kPropertyGrid.spacing * scale};
    const Mesh large = moved(mesh, [&](Vec3 v) { return v * scale; });
    for (const double thickness : kThicknesses) {
      const ComputeResult a = computed(mesh, kPropertyGrid, thickness), b = computed(large, grid, thickness * scale);
      std::vector<float> expected = a.field.to_dense();
      for (float& value : expected) value *= static_cast<float>(scale);
      EXPECT_TRUE(bits_of(expected) == bits_of(b.field.to_dense())) << scale << ' ' << thickness;
      EXPECT_TRUE(all_nearest(a.field) == all_nearest(b.field));
    }
  }
}

TEST(TilesProperties, SubdividingTrianglesChangesNothingButRounding) {
  for (const double side : {1.0, 12.0}) {
    const Mesh mesh = random_soup(40, 40, 6, side);
    Mesh finer;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const Vec3 a = MeshView(mesh).corner(t, 0), b = MeshView(mesh).corner(t, 1), c = MeshView(mesh).corner(t, 2);
      const Vec3 ab = (a + b) * 0.5, bc = (b + c) * 0.5, ca = (c + a) * 0.5;
      add_triangle(finer, a, ab, ca);
      add_triangle(finer, ab, b, bc);
      add_triangle(finer, ca, bc, c);
      add_triangle(finer, ab, bc, ca);
    }
    for (const double thickness : kThicknesses)
      expect_near(computed(mesh, kPropertyGrid, thickness).field, computed(finer, kPropertyGrid, thickness).field,
                  kSame);
  }
}

// The field by one of the two algorithms, whichever would be faster. `wanted`: as in Job.
DistanceField computed_by(cpu::BandAlgorithm algorithm, const Mesh& mesh, const Grid& grid, double thickness,
                          std::span<const std::uint8_t> wanted = {}) {
  DistanceField field;
  field.reset(grid, thickness, true);
  Sink sink(field);
  ProgressMeter progress;
  cpu::run_tiles_by({algorithm, {}}, {mesh, {}, grid, thickness, 2, Simd::automatic, progress, {}, wanted}, sink);
  return field;
}

// Of triangles of the size of samples, and of specks, which tiles gather in another way.
TEST(TilesProperties, TilesThatAreWantedHaveAllTheirBits) {
  Mesh specks = random_soup(45, 300, 1e-6, 1e-7);
  add_triangle(specks, {9, 3, 12}, {9, 3, 12.1}, {9, 3.1, 12});
  for (const Mesh& mesh : {random_soup(46, 300, 6, 0.6), specks}) {
    const Size3 tiles = DistanceField::tiles_of(kPropertyGrid.size);
    std::vector<std::uint8_t> wanted(static_cast<std::size_t>(tiles.count()));
    Random random(47);
    for (std::uint8_t& one : wanted) one = random.below(2) != 0;
    for (const double thickness : {8.5, kInfinity}) {
      const DistanceField all = computed_by(cpu::BandAlgorithm::descent, mesh, kPropertyGrid, thickness),
                          some = computed_by(cpu::BandAlgorithm::descent, mesh, kPropertyGrid, thickness, wanted);
      for_each_sample(kPropertyGrid, [&](auto i, auto j, auto k) {
        if (wanted[static_cast<std::size_t>(i / 8 + tiles.x * (j / 8 + tiles.y * (k / 8)))] == 0) return;
        ASSERT_EQ(some.value(i, j, k), all.value(i, j, k));
        ASSERT_EQ(some.nearest(i, j, k), all.nearest(i, j, k));
      });
    }
  }
}

TEST(TilesProperties, BothAlgorithmsGiveTheSameBitsAtAnyThickness) {
  for (const double side : {0.3, 1.5, 30.0}) {
    const Mesh mesh = random_soup(41, 80, 6, side);
    const DistanceField full = computed(mesh, kPropertyGrid, kInfinity).field;
    for (const double thickness : {0.4, 1.7, 2.6, 5.5, 20.0}) {
      const auto limit = static_cast<float>(thickness);
      const DistanceField by_bins = computed_by(cpu::BandAlgorithm::bins, mesh, kPropertyGrid, thickness),
                          by_descent = computed_by(cpu::BandAlgorithm::descent, mesh, kPropertyGrid, thickness);
      for_each_sample(kPropertyGrid, [&](auto i, auto j, auto k) {
        const float value = full.value(i, j, k);
        ASSERT_EQ(by_bins.value(i, j, k), std::min(value, limit)) << side << ' ' << thickness;
        ASSERT_EQ(by_descent.value(i, j, k), std::min(value, limit)) << side << ' ' << thickness;
        ASSERT_EQ(by_bins.nearest(i, j, k), by_descent.nearest(i, j, k)) << side << ' ' << thickness;
        if (value < limit) {
          ASSERT_EQ(by_bins.nearest(i, j, k), full.nearest(i, j, k)) << side << ' ' << thickness;
        }
      });
    }
  }
}

// A field is the minimum of the fields of the mesh's parts, bit for bit. The parts are so small that no block culls its
// cell's candidates.
void expect_least_of_parts(const Mesh& mesh, const Grid& grid, double thickness) {
  SCOPED_TRACE(::testing::Message() << grid.size.x << " samples wide, thickness " << thickness);
  constexpr std::size_t kPart = 40;
  const DistanceField whole = computed_by(cpu::BandAlgorithm::descent, mesh, grid, thickness);
  std::vector<DistanceField> parts;
  for (std::size_t first = 0; first < mesh.triangles.size(); first += kPart) {
    const auto all = std::span(mesh.triangles);
    const MeshView part{mesh.vertices, all.subspan(first, std::min(kPart, all.size() - first))};
    parts.push_back(computed(part, grid, thickness).field);
  }
  for_each_sample(grid, [&](auto i, auto j, auto k) {
    float least = std::numeric_limits<float>::infinity();
    for (const DistanceField& part : parts) least = std::min(least, part.value(i, j, k));
    ASSERT_EQ(whole.value(i, j, k), least) << i << ' ' << j << ' ' << k;
    const std::uint32_t nearest = whole.nearest(i, j, k);
    if (nearest != kNoTriangle) {
      ASSERT_EQ(parts[nearest / kPart].value(i, j, k), least) << i << ' ' << j << ' ' << k;
    }
  });
}

TEST(TilesProperties, CrowdedCellsLoseNothing) {
  const Mesh mesh = crowd(42, 1200);
  const Grid grids[] = {kPropertyGrid, {{20, 20, 20}, {-11, -3, 2}, {0.3, 1.1, 0.45}}};
  for (const Grid& grid : grids)
    for (const double thickness : {4.5 * grid.max_spacing(), kInfinity}) expect_least_of_parts(mesh, grid, thickness);
}

TEST(TilesProperties, CrowdedCellsWhoseNodesAreSmallLoseNothing) {
  // Sixteen triangles in less than a spacing, and many such nodes in a cell: its samples cull them before any is
  // opened. If they are opened first, 52,000 distances are computed instead of 43,000.
  const Mesh mesh = random_soup(48, 40000, 3, 0.05);
  const Grid grid{{9, 9, 9}, {-5, -5, -5}, {1.25, 1.25, 1.25}};
  EXPECT_LT(computed(mesh, grid, kInfinity).report.samples_examined, 47000);
  expect_least_of_parts(mesh, grid, kInfinity);
}

TEST(TilesProperties, BlocksOfACrowdWithinASpacingLookAtFewTriangles) {
  // Triangles so small that tiles get nodes of nodes. If each of these counts as sixteen triangles, tiles do not count
  // as crowded, and 34,000 distances are computed instead of 22,000.
  const Mesh mesh = random_soup(26, 20000, 1, 0.018);
  const ComputeResult found = computed(mesh, {{9, 9, 9}, {-5, -5, -5}, {1.25, 1.25, 1.25}}, kInfinity);
  EXPECT_LT(found.report.samples_examined, 28000);
}

TEST(TilesProperties, ALongTriangleDoesNotMakeBlocksLookAtMore) {
  const Grid grid{{12, 12, 12}, {-3, -3, -3}, {0.6, 0.6, 0.6}};
  for (const int triangles : {300, 1000, 6000}) {  // culled by distances from corners first, or by boxes at once
    Mesh mesh = crowd(47, triangles);
    const auto examined = [&] { return computed(mesh, grid, kInfinity).report.samples_examined; };
    const std::int64_t before = examined();
    add_triangle(mesh, {-3e5, -2e5, -1}, {3e5, -2e5, -1}, {0, 4e5, -1});
    EXPECT_LT(examined(), before + before / 10) << triangles;
  }
}

TEST(TilesProperties, CrowdedTilesLoseNothing) {
  // More triangles per cell than a table holds, and some as long as the grid among the small ones.
  Mesh mesh = crowd(43, 6000);
  Random random(44);
  for (int n = 0; n < 10; ++n) add_triangle(mesh, random.in_cube(9), random.in_cube(9), random.in_cube(9));
  const Grid grids[] = {{{12, 11, 10}, {-3, -3, -3}, {0.6, 0.6, 0.6}},
                        {{9, 17, 5}, {-2, -6, -4}, {0.5, 0.7, 1.9}},
                        {{8, 8, 8}, {4000, 2000, -1000}, {30, 40, 50}}};
  for (const Grid& grid : grids)
    for (const double thickness : {4.5 * grid.max_spacing(), kInfinity}) expect_least_of_parts(mesh, grid, thickness);
}

}  // namespace
}  // namespace standoff::testing
