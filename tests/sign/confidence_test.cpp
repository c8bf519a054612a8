// SPDX-License-Identifier: Apache-2.0
// labels: memory threads
// How sure a sign is: margins against winding numbers as sums of solid angles, and the shares of samples in doubt.
#include "standoff/confidence.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "standoff/compute.h"
#include "tests/sign/shapes.h"
#include "tests/sign/solid_angles.h"
#include "tests/support/expect_error.h"

namespace standoff {
namespace {

const Grid kConfidenceGrid{{20, 18, 16}, {-1.31, -1.27, -1.23}, {0.137, 0.149, 0.163}};

SignConfidence confidence_of(const Mesh& mesh, SignMethod method) {
  const SignOptions sign{.method = method};
  const DistanceField field = compute(mesh, kConfidenceGrid, 0.4, {.sign = sign}).field;
  return sign_confidence(mesh, field, winding_margins(mesh, kConfidenceGrid, {.sign = sign}));
}

TEST(Confidence, MarginsAreTheDistanceOfTheWindingNumberFromOddHalves) {
  Mesh holes = testing::sphere(8);
  for (const std::size_t triangle : {150, 90, 91, 30, 3}) holes = testing::without(holes, triangle);
  const std::vector<float> margins = winding_margins(holes, kConfidenceGrid, {.sign = {.as_oriented = true}});
  ASSERT_EQ(margins.size(), 20u * 18 * 16);
  double least = 1, off = 0;
  for (std::int64_t k = 0; k < 16; ++k)
    for (std::int64_t j = 0; j < 18; ++j)
      for (std::int64_t i = 0; i < 20; ++i) {
        const double w = testing::winding_number(holes, kConfidenceGrid.position(i, j, k)),
                     margin = 0.5 - std::abs(w - std::round(w));
        const double found = margins[static_cast<std::size_t>(kConfidenceGrid.index(i, j, k))];
        least = std::min(least, found);
        off = std::max(off, std::abs(found - margin));
      }
  EXPECT_LE(off, 1.1e-3);
  EXPECT_LT(least, 0.3);
}

// Crossings of at most 2^17 rows of tiles are held at once.
TEST(Confidence, MarginsOfMoreRowsThanAreHeldAtOnce) {
  const Grid grid{{1, 2904, 2904}, {}, {1, 1, 1}};
  const Mesh sheet{{{-0.5, 2890, 2890}, {0.7, 2910, 2890}, {0.4, 2895, 2915}}, {{0, 1, 2}}};
  const std::vector<float> margins = winding_margins(sheet, grid, {.sign = {.as_oriented = true}});
  double least = 1;
  for (std::int64_t k = 2880; k < 2904; ++k)
    for (std::int64_t j = 2880; j < 2904; ++j) {
      const double w = testing::winding_number(sheet, grid.position(0, j, k));
      const double found = margins[static_cast<std::size_t>(grid.index(0, j, k))];
      least = std::min(least, found);
      EXPECT_NEAR(found, 0.5 - std::abs(w - std::round(w)), 1.1e-3) << j << ' ' << k;
    }
  EXPECT_LT(least, 0.1);
}

TEST(Confidence, OfClosedMeshesIsComplete) {
  const Mesh ball = testing::sphere(8);
  EXPECT_TRUE(std::ranges::all_of(winding_margins(ball, kConfidenceGrid), [](float margin) { return margin == 0.5f; }));
  const SignConfidence found = confidence_of(ball, SignMethod::winding);
  EXPECT_GT(found.samples, 1000);
  EXPECT_EQ(found.doubtful, 0);
  EXPECT_EQ(found.axes_disagree, 0);
  EXPECT_EQ(found.flood_disagrees, 0);
  // A cavity is not outside, but nothing comes to it.
  const Mesh hollow = testing::joined(ball, testing::reversed(testing::moved(ball, {}, 0.5)));
  const SignConfidence cavity = confidence_of(hollow, SignMethod::winding);
  EXPECT_EQ(cavity.axes_disagree, 0);
  EXPECT_GT(cavity.flood_disagrees, 0);
}

TEST(Confidence, OfHalfABallIsSmall) {
  Mesh half = testing::sphere(8);
  std::erase_if(half.triangles, [&](const Triangle& t) { return half.vertices[t[0]].z > 0.2; });
  const SignConfidence found = confidence_of(half, SignMethod::winding);
  EXPECT_GT(found.doubtful, 0.001);
  EXPECT_GT(found.axes_disagree, 0.01);
  EXPECT_GT(found.flood_disagrees, 0.01);  // it comes in
}

TEST(Confidence, MarginsOfAnotherGrid) {
  const Mesh ball = testing::sphere(8);
  const DistanceField field = compute(ball, kConfidenceGrid, 0.4, {.sign = {SignMethod::none}}).field;
  expect_error([&] { sign_confidence(ball, field, std::vector<float>(3)); }, ErrorCode::usage, "a margin for each");
}

}  // namespace
}  // namespace standoff
