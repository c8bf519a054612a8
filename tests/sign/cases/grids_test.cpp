// SPDX-License-Identifier: Apache-2.0
// The same solids on grids of every kind: tiny and huge, far away, of unequal spacings, within the solid and without,
// smaller than the mesh, of one sample; and samples next to a face by one step of a double.
#include <gtest/gtest.h>

#include "standoff/testing/emulation.h"
#include "tests/sign/cases/known_sides.h"
#include "tests/sign/cases/solids.h"

namespace standoff {
namespace {

using namespace testing;  // NOLINT: a test of what that folder has

constexpr SignOptions kAll[] = {kWinding, kParity, kNormal, kFlood, kAutomatic};
constexpr SignOptions kWherever[] = {kWinding, kParity, kNormal, kAutomatic};  // all that see beyond the grid

const Mesh kBall = sphere(6);

/// Calls use(mesh, method) for a ball and one with a hole, which only the methods for open meshes see as one.
template <class Use>
void for_each_ball(std::span<const SignOptions> methods, const Use& use) {
  for (const SignOptions& sign : methods) {
    SCOPED_TRACE(std::string("closed, ") + name_of(sign.method));
    use(kBall, sign);
  }
  for (const SignOptions& sign : {kWinding, kAutomatic}) {
    SCOPED_TRACE(std::string("open, ") + name_of(sign.method));
    use(without(kBall, 40), sign);
  }
}

Grid moved_grid(Grid grid, Vec3 by, double scale) {
  grid.origin = grid.origin * scale + by;
  grid.spacing = grid.spacing * scale;
  return grid;
}

TEST(GridCases, ScalesAndOffsets) {
  const Grid grid = grid_around(kBall, 17);
  for (const double scale : {1e-30, 1e-9, 1.0, 1e9, 1e30})
    for (const double offset : {0.0, -1e6}) {
      SCOPED_TRACE(std::to_string(std::log10(scale)) + ", " + std::to_string(offset));
      const Vec3 by = Vec3{offset, -offset, 0.5 * offset} * scale;
      const Convex known(testing::moved(kBall, by, scale), offset == 0 ? 1e-9 : 1e-8);  // a million sides times 2^-53
      for_each_ball(kAll, [&](const Mesh& mesh, const SignOptions& sign) {
        expect_sides(testing::moved(mesh, by, scale), moved_grid(grid, by, scale), sign, known);
      });
    }
}

TEST(GridCases, UnequalSpacings) {
  for (const Vec3 step : {Vec3{0.03, 0.31, 0.1}, Vec3{0.31, 0.1, 0.03}, Vec3{0.1, 0.03, 0.31}}) {
    const auto samples = [](double s) { return static_cast<std::int64_t>(2.9 / s); };
    const Grid grid{{samples(step.x), samples(step.y), samples(step.z)}, {-1.41, -1.42, -1.43}, step};
    for_each_ball(kAll,
                  [&](const Mesh& mesh, const SignOptions& sign) { expect_sides(mesh, grid, sign, Convex(kBall)); });
  }
}

TEST(GridCases, WhollyInside) {
  const Grid grid{{11, 9, 17}, {-0.3, -0.2, -0.3}, {0.05, 0.05, 0.04}};
  for_each_ball(kWherever, [&](const Mesh& mesh, const SignOptions& sign) {
    EXPECT_EQ(compare_sides(mesh, grid, sign, Convex(kBall), 0.01).inside, grid.sample_count());
    expect_sides(mesh, grid, sign, Convex(kBall), 0.01);
  });
  expect_sides(reversed(kBall), grid, kWinding, Convex(kBall));
}

// A flood begins at the grid's border. Where that is within the solid it says nothing, or says so.
TEST(GridCases, FloodThatBeginsInside) {
  for (const Vec3 low : {Vec3{-0.3, -0.2, -0.3}, Vec3{-0.2, -0.3, 0.1}}) {  // wholly inside, and half of it
    const Grid grid{{9, 9, 17}, low, {0.05, 0.05, 0.08}};
    const Compared found = compare_sides(kBall, grid, kFlood, Convex(kBall));
    EXPECT_TRUE(found.wrong == 0 || !found.report.sure) << found.wrong << " are wrong, and it is sure";
  }
}

// No tile of a thin band is stored: all that is said is each tile's side.
TEST(GridCases, NoTileIsStored) {
  ComputeOptions options{.sign = {SignMethod::none}};
  for (const SignOptions& sign : kWherever)
    for (const bool inside : {true, false}) {
      options.sign = sign;
      const Grid grid{{30, 20, 10}, {inside ? -0.1 : 5, -0.1, -0.1}, {0.005, 0.005, 0.005}};
      const DistanceField field = compute(kBall, grid, 0.01, options).field;
      EXPECT_EQ(field.stored_tiles(), 0) << name_of(sign.method);
      for (const float value : field.to_dense()) ASSERT_EQ(value, inside ? -0.01f : 0.01f) << name_of(sign.method);
    }
}

TEST(GridCases, WhollyOutside) {
  for (const Vec3 at : {Vec3{3, 0, 0}, Vec3{-6, 0, 0}, Vec3{0, 4, -1}, Vec3{0.1, 0.2, -9}}) {
    const Grid grid{{13, 11, 9}, at, {0.11, 0.13, 0.17}};
    for_each_ball(kAll, [&](const Mesh& mesh, const SignOptions& sign) {
      expect_sides(mesh, grid, sign, [](Vec3) { return Side::outside; });
    });
  }
}

TEST(GridCases, MeshLargerThanTheGrid) {
  const Mesh ring = torus(24, 12);
  const RoundTorus known(24, 12, 1, 0.3);
  // Cuts the tube; the rest of the ring lies on all sides of the grid but one.
  const Grid grid{{13, 14, 15}, {-0.21, 0.6, -0.3}, {0.045, 0.06, 0.045}};
  for (const SignOptions& sign : kWherever) expect_sides(ring, grid, sign, known);
  const Mesh open = without(without(ring, 5), 300);
  expect_sides(open, grid, kWinding, ByWinding(open, grid));
}

TEST(GridCases, FewSamples) {
  for (const Vec3 p :
       {Vec3{0.01, 0.02, 0.03}, Vec3{0.9, 0, 0.01}, Vec3{1.01, 0, 0}, Vec3{-5, 0.01, 0.02}, Vec3{0, 1e-300, 0}})
    for (const Size3 size : {Size3{1, 1, 1}, Size3{3, 1, 1}, Size3{1, 4, 1}, Size3{1, 1, 9}})
      for_each_ball(kWherever, [&](const Mesh& mesh, const SignOptions& sign) {
        expect_sides(mesh, {size, p, {0.013, 0.017, 0.019}}, sign, Convex(kBall, 1e-12));
      });
}

// A cube's face x = 1, and samples one step of a double to either side of it. A field has no such distances, voxels
// have such sides.
TEST(GridCases, SamplesNextToAFace) {
  const Mesh cube = box({-1, -1, -1}, {1, 1, 1});
  const double below = std::nextafter(1.0, 0.0), above = std::nextafter(1.0, 2.0);
  for (const SignOptions& sign : {kWinding, kParity, kAutomatic})
    for (const double y : {-0.5, 0.0, 0.25, below})
      for (const double z : {-below, 0.0, 0.3}) {
        const auto inside = [&](Vec3 p) { return occupancy(cube, {{1, 1, 1}, p}, {.sign = sign}).inside(0, 0, 0); };
        EXPECT_TRUE(inside({below, y, z}));
        EXPECT_FALSE(inside({above, y, z}));
        EXPECT_TRUE(inside({-below, y, z}));
        EXPECT_FALSE(inside({-above, y, z}));
        EXPECT_FALSE(inside({y, above, z}));
        EXPECT_TRUE(inside({y, z, below}));
        EXPECT_FALSE(inside({y, z, -above}));
      }
}

// A slanted plane through lattice points: which side a sample is on, integers tell.
TEST(GridCases, SamplesNextToASlantedFace) {
  const Mesh solid = octahedron(0x1p40);
  const Grid grid{{9, 9, 9}, {0x1p38 - 4, 0x1p38 - 4, 0x1p39 - 4}};  // about a point of x + y + z = 2^40
  for (const SignOptions& sign : {kWinding, kParity, kAutomatic}) {
    const Occupancy voxels = occupancy(solid, grid, {.sign = sign});
    std::int64_t wrong = 0;
    for_each_sample(grid, [&](std::int64_t i, std::int64_t j, std::int64_t k) {
      const std::int64_t beyond = (i - 4) + (j - 4) + (k - 4);
      wrong += beyond != 0 && voxels.inside(i, j, k) != (beyond < 0);
    });
    EXPECT_EQ(wrong, 0) << name_of(sign.method);
  }
}

// Any number of threads, and the emulated GPU, give the same bits.
TEST(GridCases, WhereverTheWorkRuns) {
  const Grid grid = grid_around(kBall, 27);
  const auto values = [&](const Mesh& mesh, const SignOptions& sign, const Execution& execution) {
    return bits_of(compute(mesh, grid, 0.2, {.sign = sign, .execution = execution}).field.to_dense());
  };
  for_each_ball(kAll, [&](const Mesh& mesh, const SignOptions& sign) {
    const auto first = values(mesh, sign, {.threads = 1});
    for (const int threads : {2, 5})
      EXPECT_TRUE(values(mesh, sign, {.threads = threads}) == first) << threads << " threads";
    EXPECT_TRUE(values(mesh, sign, {.backend = testing::kEmulated}) == first) << "emulated";
  });
}

TEST(GridCases, VoxelsHaveTheVolumeOfTheSolid) {
  const Grid grid{{65, 63, 61}, {-1.21, -1.22, -1.23}, {0.039, 0.04, 0.041}};
  const double voxel = grid.spacing.x * grid.spacing.y * grid.spacing.z;
  const Mesh ring = torus(60, 40, 0.8, 0.3);
  // Pappus; the polygon of n sides in a circle has sin(2 pi / n) / (2 pi / n) of its area, twice.
  const double kPi = std::numbers::pi,
               kept = std::sin(2 * kPi / 40) / (2 * kPi / 40) * std::sin(2 * kPi / 60) / (2 * kPi / 60);
  const double volume = 2 * kPi * kPi * 0.8 * 0.3 * 0.3 * kept;
  for (const SignOptions& sign : {kWinding, kParity, kFlood, kAutomatic})
    EXPECT_NEAR(double(occupancy(ring, grid, {.sign = sign}).count()) * voxel, volume, 0.01 * volume)
        << name_of(sign.method);
}

}  // namespace
}  // namespace standoff
