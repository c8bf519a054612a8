// SPDX-License-Identifier: Apache-2.0
// Which algorithm takes a band. The choice costs time alone: that both give the same bits is in properties_test.cpp.
#include "field/cpu/band_choice.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <numeric>
#include <vector>

#include "standoff/compute.h"
#include "tests/support/changed_mesh.h"
#include "tests/support/fields.h"
#include "tests/support/welded_ball.h"

namespace standoff::testing {
namespace {

using cpu::BandAlgorithm;

const Grid kChoiceGrid{{128, 128, 128}, {-1.27, -1.27, -1.27}, {0.02, 0.02, 0.02}};

// `thickness`: in spacings.
cpu::BandChoice choice(const Mesh& mesh, double thickness, std::vector<std::uint32_t> kept = {}) {
  ProgressMeter progress;
  return cpu::choose_band({mesh, kept, kChoiceGrid, thickness * kChoiceGrid.spacing.x, 1, Simd::automatic, progress});
}
BandAlgorithm chosen(const Mesh& mesh, double thickness, std::vector<std::uint32_t> kept = {}) {
  return choice(mesh, thickness, std::move(kept)).algorithm;
}

TEST(BandChoice, LargeTrianglesAreSortedIntoBricksUpToThickBands) {
  const Mesh mesh = welded_ball(1, 6);  // triangles of some 13 samples
  EXPECT_EQ(chosen(mesh, 2), BandAlgorithm::bins);
  EXPECT_EQ(chosen(mesh, 8), BandAlgorithm::bins);
  EXPECT_EQ(chosen(mesh, 17), BandAlgorithm::descent);
  EXPECT_EQ(chosen(mesh, kInfinity), BandAlgorithm::descent);
}

TEST(BandChoice, TrianglesOfASampleAreSortedIntoBricksOnlyForThinBands) {
  const Mesh mesh = unwelded(welded_ball(1, 80));  // no regions
  EXPECT_EQ(chosen(mesh, 2), BandAlgorithm::bins);
  EXPECT_EQ(chosen(mesh, 6), BandAlgorithm::descent);
}

TEST(BandChoice, ScansOfTrianglesOfSomeSamplesGetRegions) {
  const Mesh mesh = welded_ball(1, 26);
  for (const double thickness : {5.0, 8.0, 12.0}) {
    const cpu::BandChoice taken = choice(mesh, thickness);
    EXPECT_EQ(taken.algorithm, BandAlgorithm::bins) << thickness;
    EXPECT_EQ(taken.regions.size(), mesh.triangles.size()) << thickness;
  }
  EXPECT_TRUE(choice(mesh, 4).regions.empty());
  EXPECT_TRUE(choice(unwelded(mesh), 6).regions.empty());
}

// Sheets in each other's bands: the descent visits no sample twice, though each sheet alone has as many.
TEST(BandChoice, LayersTakeTheDescent) {
  Mesh layers;
  for (int n = 0; n < 24; ++n) layers = joined(std::move(layers), welded_ball(0.8 + 0.01 * n, 26));
  EXPECT_EQ(chosen(layers, 14), BandAlgorithm::descent);
}

TEST(BandChoice, OnlyTrianglesInReachOfTheGridAndInUseCount) {
  const Mesh few = welded_ball(1, 6), many = unwelded(welded_ball(1, 80)), both = joined(few, many);
  std::vector<std::uint32_t> few_kept(few.triangles.size());
  std::iota(few_kept.begin(), few_kept.end(), 0u);
  EXPECT_EQ(chosen(both, 8), BandAlgorithm::descent);
  EXPECT_EQ(chosen(both, 8, few_kept), BandAlgorithm::bins);
  EXPECT_EQ(chosen(joined(few, moved(many, {10, 0, 0})), 8), BandAlgorithm::bins);
}

TEST(BandChoice, ExtremeMeshesOverflowNothing) {
  const auto scaled = [](double scale) { return moved(welded_ball(1, 6), {}, scale); };
  EXPECT_EQ(chosen(scaled(1e-300), 8), BandAlgorithm::descent);  // all in a point: each would be measured around it
  for (const double scale : {1e15, 1e145}) {
    EXPECT_EQ(chosen(scaled(scale), 2), BandAlgorithm::bins) << scale;
    EXPECT_EQ(chosen(scaled(scale), 8), BandAlgorithm::bins) << scale;
    EXPECT_EQ(chosen(scaled(scale), 20), BandAlgorithm::descent) << scale;
  }
}

}  // namespace
}  // namespace standoff::testing
