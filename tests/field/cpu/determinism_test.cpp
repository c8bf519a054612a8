// SPDX-License-Identifier: Apache-2.0
// The method tiles: the same bits for any number of threads, any run, any instruction set and either kind of memory.
// labels: threads
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <limits>

#include "standoff/compute.h"
#include "tests/support/fields.h"
#include "tests/support/random_mesh.h"

namespace standoff::testing {
namespace {

// Odd sizes, ties, slivers, long triangles, and enough of them that threads share the work.
Mesh mixed_mesh(int triangles) {
  Mesh mesh = nasty_soup(51, 100, 8);
  for (const double side : {0.2, 1.0, 30.0}) {
    const Mesh soup = random_soup(52, side > 10 ? 10 : triangles, 8, side);
    for (std::size_t t = 0; t < soup.triangles.size(); ++t)
      add_triangle(mesh, MeshView(soup).corner(t, 0), MeshView(soup).corner(t, 1), MeshView(soup).corner(t, 2));
  }
  return mesh;
}

const Grid kGrid{{37, 41, 29}, {-9, -10, -7}, {0.5, 0.5, 0.5}};
constexpr double kThicknesses[] = {0.9, 2.6, kInfinity};

bool is_supported(Simd simd) {
  try {
    computed(random_soup(53, 1, 1, 1), {{2, 2, 2}, {0, 0, 0}, {1, 1, 1}}, 1, simd);
    return true;
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::usage);
    EXPECT_NE(std::string(error.what()).find("instruction set"), std::string::npos) << error.what();
    return false;
  }
}

TEST(TilesDeterminism, AnyNumberOfThreadsAndAnyRun) {
  const Mesh mesh = mixed_mesh(4000);
  for (const double thickness : kThicknesses) {
    const ComputeResult one = computed(mesh, kGrid, thickness, Simd::automatic, 1);
    for (const int threads : {1, 2, 3, 8}) {
      SCOPED_TRACE(::testing::Message() << threads << " threads, thickness " << thickness);
      const ComputeResult many = computed(mesh, kGrid, thickness, Simd::automatic, threads);
      expect_same_bits(one.field, many.field);
      EXPECT_EQ(many.report.threads, threads);
      EXPECT_EQ(one.field.stored_tiles(), many.field.stored_tiles());
      EXPECT_EQ(one.report.samples_band, many.report.samples_band);
      EXPECT_EQ(one.report.samples_examined, many.report.samples_examined);
    }
  }
}

void expect_any_instruction_set(const Mesh& mesh, const Grid& grid) {
  for (const double thickness : kThicknesses) {
    const ComputeResult portable = computed(mesh, grid, thickness, Simd::portable);
    EXPECT_EQ(portable.report.device, "portable");
    for (const auto& [simd, name] : {std::pair{Simd::avx2, "avx2"}, std::pair{Simd::avx512, "avx512"}}) {
      if (!is_supported(simd)) continue;
      SCOPED_TRACE(::testing::Message() << name << ", thickness " << thickness);
      const ComputeResult wide = computed(mesh, grid, thickness, simd);
      EXPECT_EQ(wide.report.device, name);
      expect_same_bits(portable.field, wide.field);
      EXPECT_EQ(portable.report.samples_examined, wide.report.samples_examined);
      EXPECT_EQ(portable.report.samples_band, wide.report.samples_band);
    }
  }
}

TEST(TilesDeterminism, AnyInstructionSet) {
  expect_any_instruction_set(mixed_mesh(100), {{19, 18, 21}, {-4.4, -4.3, -4.6}, {0.5, 0.5, 0.5}});
}

TEST(TilesDeterminism, AnyInstructionSetWhereTilesAreCrowded) {
  expect_any_instruction_set(crowd(45, 3000), {{13, 11, 9}, {-3, -3, -3}, {0.6, 0.6, 0.6}});
  expect_any_instruction_set(random_soup(48, 40000, 3, 0.05), {{9, 9, 9}, {-5, -5, -5}, {1.25, 1.25, 1.25}});
}

TEST(TilesDeterminism, TheOrderOfTrianglesOfACrowd) {
  const Grid grid{{21, 13, 17}, {-6, -3, -5}, {0.6, 0.45, 0.3}};
  Mesh mesh = crowd(46, 3000);
  const ComputeResult before = computed(mesh, grid, kInfinity);
  std::ranges::reverse(mesh.triangles);
  EXPECT_TRUE(bits_of(before.field.to_dense()) == bits_of(computed(mesh, grid, kInfinity).field.to_dense()));
}

TEST(TilesDeterminism, DenseMemoryIsFilledWhateverItHeld) {
  const Mesh mesh = mixed_mesh(300);
  const auto samples = static_cast<std::size_t>(kGrid.sample_count());
  for (const double thickness : kThicknesses) {
    const ComputeResult sparse = computed(mesh, kGrid, thickness);
    ComputeOptions options{.sign = {SignMethod::none}, .nearest = true};
    std::vector<float> values(samples, std::bit_cast<float>(0xffc0deadu));
    std::vector<std::uint32_t> nearest(samples, 0xdeadbeefu);
    const ComputeReport report = compute_into(mesh, kGrid, thickness, values, nearest, options);
    EXPECT_TRUE(bits_of(values) == bits_of(sparse.field.to_dense()));
    EXPECT_TRUE(nearest == all_nearest(sparse.field));
    EXPECT_EQ(report.samples_band, sparse.report.samples_band);

    std::vector<float> alone(samples, std::numeric_limits<float>::quiet_NaN());
    options.nearest = false;
    compute_into(mesh, kGrid, thickness, alone, options);
    EXPECT_TRUE(values == alone) << "asking for nearest triangles changes no value";
  }
}

TEST(TilesDeterminism, TheExactSkipRuleChangesNoBit) {
  const Mesh mesh = mixed_mesh(300);
  for (const double thickness : kThicknesses) {
    ComputeOptions options{.skip = {.kind = SkipRule::Kind::exact}, .sign = {SignMethod::none}, .nearest = true};
    const ComputeResult skipped = compute(mesh, kGrid, thickness, options);
    EXPECT_GT(skipped.report.skipped, 0);
    expect_same_bits(skipped.field, computed(mesh, kGrid, thickness).field);
  }
}

TEST(TilesDeterminism, StoredTilesHoldTheThicknessPastTheGrid) {
  const Mesh mesh = mixed_mesh(100);
  for (const double thickness : kThicknesses) {
    const DistanceField field = computed(mesh, kGrid, thickness).field;
    for (const auto& [index, at, values, nearest] : field.tiles())
      for (int n = 0; n < DistanceField::kTileSamples; ++n) {
        if (8 * at.x + n % 8 < kGrid.size.x && 8 * at.y + n / 8 % 8 < kGrid.size.y && 8 * at.z + n / 64 < kGrid.size.z)
          continue;
        ASSERT_EQ(values[n], static_cast<float>(thickness));
        ASSERT_EQ(nearest[n], kNoTriangle);
      }
  }
}

}  // namespace
}  // namespace standoff::testing
