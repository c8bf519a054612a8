// SPDX-License-Identifier: Apache-2.0
// labels: threads

#include "thesis/thesis.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "core/threads.h"
#include "tests/support/fields.h"
#include "tests/support/random_mesh.h"

namespace standoff::testing {
namespace {

struct Outcome {
  DistanceField field;
  Counts counts;
};

Outcome run(MeshView mesh, const Grid& grid, double thickness, int threads = 2, std::vector<std::uint32_t> kept = {},
            const ComputeOptions& options = {}) {
  Outcome result{DistanceField(grid, thickness, true), {}};
  Sink sink(result.field);
  ProgressMeter progress(options.progress);
  const Job job{mesh, kept, grid, thickness, threads, Simd::automatic, progress};
  Threads(threads).run([&] { result.counts = cpu::run_thesis(job, sink); });
  return result;
}

// Two float roundings of the largest coordinate difference there is: between a brick's centre and a triangle or sample.
double rounding(MeshView mesh, const Grid& grid) {
  Box box = bounds(mesh);
  box.include(grid.bounds().min);
  box.include(grid.bounds().max);
  return 2 * 0x1p-23 * (length(box.extent()) + 16 * grid.max_spacing());
}

void expect_within_rounding(const Mesh& mesh, const Grid& grid, double thickness) {
  const Outcome result = run(mesh, grid, thickness);
  const double allowed = rounding(mesh, grid);
  std::int64_t band_at_least = 0, band_at_most = 0;
  for_each_sample(grid, [&](auto i, auto j, auto k) {
    const Vec3 p = grid.position(i, j, k);
    const double distance = reference_distance(mesh, p);
    band_at_least += distance < thickness - allowed;
    band_at_most += distance < thickness + allowed;
    ASSERT_NEAR(result.field.value(i, j, k), std::min(distance, thickness), allowed) << i << ' ' << j << ' ' << k;
    const std::uint32_t nearest = result.field.nearest(i, j, k);
    if (distance < thickness - allowed) {
      ASSERT_LT(nearest, mesh.triangles.size());
      ASSERT_NEAR(reference_distance(mesh, nearest, p), distance, 2 * allowed);
    } else if (distance > thickness + allowed) {
      ASSERT_EQ(nearest, kNoTriangle);
    }
  });
  EXPECT_GE(result.counts.samples_band, band_at_least);
  EXPECT_LE(result.counts.samples_band, band_at_most);
}

TEST(Thesis, IsExactWithoutSkippingForAnyGrid) {
  const Mesh mesh = random_soup(1, 60, 5, 1.5);
  const Grid grids[] = {{{23, 19, 21}, {-6, -5.5, -6.25}, {0.55, 0.6, 0.6}},
                        {{37, 5, 40}, {-7, -4, -6}, {0.4, 2.2, 0.3}},
                        {{1, 1, 1}, {0.3, 0.2, 0.1}, {1, 1, 1}},
                        {{70, 1, 3}, {-6, 0, -1}, {0.17, 1, 0.7}},
                        {{8, 16, 17}, {-20, -3, -3}, {2.5, 0.5, 0.45}}};
  for (const Grid& grid : grids)
    for (const double thickness : {0.05, 1.0, 4.0, kInfinity}) expect_within_rounding(mesh, grid, thickness);
}

TEST(Thesis, IsExactOnDegenerateAndRepeatedTriangles) {
  const Mesh mesh = nasty_soup(2, 80, 6);
  expect_within_rounding(mesh, {{25, 26, 27}, {-6.1, -6.2, -6.3}, {0.5, 0.5, 0.5}}, 1.2);
  expect_within_rounding(mesh, {{9, 9, 9}, {-6.1, -6.2, -6.3}, {1.5, 1.5, 1.5}}, kInfinity);
}

TEST(Thesis, IsExactFarFromTheOriginAndAtAnyScale) {
  const Vec3 far{1e6, -2e6, 3e6};
  expect_within_rounding(random_soup(3, 40, 5, 1, far), {{24, 24, 24}, far - Vec3{6, 6, 6}, {0.5, 0.5, 0.5}}, 2);
  for (const double scale : {1e-6, 1e-20, 1e15}) {
    Mesh mesh = random_soup(4, 40, 5, 1);
    for (Vec3& v : mesh.vertices) v = v * scale;
    expect_within_rounding(mesh, {{24, 24, 24}, Vec3{-6, -6, -6} * scale, Vec3{0.5, 0.5, 0.5} * scale}, 2 * scale);
  }
}

TEST(Thesis, IsExactForOneTriangleThatCoversEverything) {
  Mesh mesh;
  add_triangle(mesh, {-900, -1000, -800}, {1100, -900, 700}, {100, 1200, 300});
  expect_within_rounding(mesh, {{40, 40, 40}, {-10, -10, -10}, {0.5, 0.5, 0.5}}, 3);
}

TEST(Thesis, CountsTheSamplesOfGrownBoxes) {
  // Coordinates, spacing and thickness are multiples of 1/8, so that samples on a box's face are decided without
  // rounding.
  Random random(5);
  const auto eighths = [&] {
    const Vec3 v = random.in_cube(40);
    return Vec3{std::round(v.x), std::round(v.y), std::round(v.z)} * 0.125;
  };
  Mesh mesh;
  for (int n = 0; n < 100; ++n) add_triangle(mesh, eighths(), eighths(), eighths());
  const Grid grid{{31, 20, 35}, {-4, -3.5, -6}, {0.25, 0.5, 0.375}};
  const double thickness = 0.625;
  std::int64_t expected = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    Box box;
    for (int k = 0; k < 3; ++k) box.include(MeshView(mesh).corner(t, k));
    const Box grown = box.grown(thickness);
    for_each_sample(grid, [&](auto i, auto j, auto k) {
      const Vec3 p = grid.position(i, j, k);
      expected += min(p, grown.min) == grown.min && max(p, grown.max) == grown.max;
    });
  }
  EXPECT_EQ(run(mesh, grid, thickness).counts.samples_examined, expected);
  EXPECT_EQ(run(mesh, grid, kInfinity).counts.samples_examined, 100 * grid.sample_count());
}

TEST(Thesis, GivesTheSameBitsForAnyNumberOfThreads) {
  // Few bricks with many triangles each, so that bricks are split between threads; every triangle twice, so that
  // there are ties.
  Mesh mesh = random_soup(6, 6000, 4, 0.5);
  const std::size_t originals = mesh.triangles.size();
  for (std::size_t t = 0; t < originals; ++t) mesh.triangles.push_back(mesh.triangles[t]);
  const Grid grid{{20, 18, 17}, {-5, -4.5, -4}, {0.5, 0.5, 0.5}};
  const Outcome one = run(mesh, grid, 1, 1);
  for (int threads = 2; threads <= 8; ++threads) {
    const Outcome many = run(mesh, grid, 1, threads);
    EXPECT_EQ(many.counts.samples_examined, one.counts.samples_examined);
    EXPECT_EQ(many.counts.samples_band, one.counts.samples_band);
    ASSERT_EQ(many.field.stored_tiles(), one.field.stored_tiles());
    for_each_sample(grid, [&](auto i, auto j, auto k) {
      ASSERT_EQ(many.field.value(i, j, k), one.field.value(i, j, k));
      ASSERT_EQ(many.field.nearest(i, j, k), one.field.nearest(i, j, k));
    });
  }
  for_each_sample(grid, [&](auto i, auto j, auto k) {
    const std::uint32_t nearest = one.field.nearest(i, j, k);
    ASSERT_TRUE(nearest == kNoTriangle || nearest < originals) << "a tie went to the later triangle";
  });
}

TEST(Thesis, FillsDenseMemoryAsItFillsTiles) {
  const Mesh mesh = random_soup(7, 50, 4, 1);
  const Grid grid{{21, 18, 9}, {-5, -4.5, -2}, {0.5, 0.5, 0.5}};
  const Outcome sparse = run(mesh, grid, 1);
  std::vector<float> values(static_cast<std::size_t>(grid.sample_count()), 1.0f);
  Sink sink(grid, values, {});
  const ComputeOptions options{.sign = {SignMethod::none}};
  ProgressMeter progress(options.progress);
  cpu::run_thesis({mesh, {}, grid, 1, 2, Simd::automatic, progress}, sink);
  EXPECT_EQ(values, sparse.field.to_dense());
}

TEST(Thesis, StoresOnlyTilesOfTheBand) {
  Mesh mesh;
  add_triangle(mesh, {4, 4, 4}, {5, 4, 4}, {4, 5, 4});
  const Grid grid{{40, 40, 40}, {0, 0, 0}, {1, 1, 1}};
  const Outcome result = run(mesh, grid, 2);
  EXPECT_EQ(result.field.stored_tiles(), 1);
  EXPECT_TRUE(result.field.tile(0, 0, 0));
  EXPECT_EQ(result.field.value(39, 39, 39), 2);
}

TEST(Thesis, SkippingOnlyRaisesDistances) {
  // A wavy sheet of triangle strips: neighbours in mesh order are neighbours in space, as in meshes made by people.
  Mesh mesh;
  Random random(8);
  const auto at = [](double x, double y) { return Vec3{x, y, std::sin(x) + std::cos(0.7 * y)}; };
  for (double y = -4; y < 4;) {
    const double dy = random.between(0.1, 0.5);
    for (double x = -4; x < 4;) {
      const double dx = random.between(0.05, 0.5);
      add_triangle(mesh, at(x, y), at(x + dx, y), at(x, y + dy));
      add_triangle(mesh, at(x + dx, y), at(x + dx, y + dy), at(x, y + dy));
      x += dx;
    }
    y += dy;
  }
  const Grid grid{{33, 33, 17}, {-4, -4, -2}, {0.25, 0.25, 0.25}};
  const double thickness = 0.5;
  const Outcome exact = run(mesh, grid, thickness);
  for (const double fraction : {1.0, 0.75, 0.5}) {
    const auto kept = kept_by_neighbour_rule(mesh, thickness, fraction);
    ASSERT_LT(kept.size(), mesh.triangles.size());
    const Outcome skipped = run(mesh, grid, thickness, 2, kept);
    EXPECT_LT(skipped.counts.samples_examined, exact.counts.samples_examined);
    double largest = 0;
    for_each_sample(grid, [&](auto i, auto j, auto k) {
      const double error = skipped.field.value(i, j, k) - exact.field.value(i, j, k);
      ASSERT_GE(error, 0) << "leaving triangles out cannot bring a sample nearer";
      largest = std::max(largest, error);
      const std::uint32_t nearest = skipped.field.nearest(i, j, k);
      ASSERT_TRUE(nearest == kNoTriangle || std::ranges::binary_search(kept, nearest));
    });
    const auto suffix = "_" + std::to_string(std::lround(100 * fraction));
    RecordProperty("largest_error" + suffix, std::to_string(largest));
    RecordProperty("skipped" + suffix, std::to_string(mesh.triangles.size() - kept.size()));
  }
}

TEST(Thesis, StopsWhenAsked) {
  ComputeOptions options{.sign = {SignMethod::none}};
  options.progress = [](const Progress& progress) { return progress.fraction < 0.5; };
  EXPECT_THROW(run(random_soup(9, 500, 20, 1), {{80, 80, 80}, {-20, -20, -20}, {0.5, 0.5, 0.5}}, 1, 2, {}, options),
               Error);
}

TEST(Thesis, SaysHowMuchScratchItNeeds) {
  const Grid grid{{100, 100, 100}, {}, {1, 1, 1}};
  const auto few = cpu::thesis_scratch_bytes({1000}, grid, 2, 1),
             many = cpu::thesis_scratch_bytes({100'000'000}, grid, 2, 1);
  EXPECT_GT(few, 0);
  EXPECT_GT(many, few + 100'000'000 * 4);
}

}  // namespace
}  // namespace standoff::testing
