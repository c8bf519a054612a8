// SPDX-License-Identifier: Apache-2.0
#include "standoff/inspect.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "scenes/scenes.h"
#include "standoff/compute.h"
#include "tests/support/heap.h"

namespace standoff {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// A field with nearest triangles counts as compute() does, one without them by its values: both say the same of samples
// none of which is exactly as far as the thickness.
TEST(Inspect, TheBandOfAField) {
  const Mesh mesh = scenes::make("sphere", 500);
  const Grid grid = fit_resolution(bounds(mesh), 37);
  ComputeOptions options{.sign = {SignMethod::none}, .execution = {.backend = Backend::cpu}};
  const double thickness = 2.5 * grid.spacing.x;
  const ComputeResult plain = compute(mesh, grid, thickness, options);
  options.nearest = true;
  const ComputeResult nearest = compute(mesh, grid, thickness, options);
  for (const ComputeResult* computed : {&plain, &nearest}) {
    const FieldSummary found = inspect(computed->field);
    EXPECT_EQ(found.band, computed->report.samples_band);
    EXPECT_GE(found.min, 0);
    EXPECT_EQ(found.max, double{static_cast<float>(thickness)});
    EXPECT_EQ(found.nan, 0);
  }
}

// Values as far inside as the thickness were clamped too: they are no band.
TEST(Inspect, TheBandOfASignedField) {
  const Grid grid{{24, 8, 8}, {}, {1, 1, 1}};
  std::vector<float> values;
  for (int n = 0; n < 24 * 64; ++n) values.push_back(static_cast<float>(std::min(n % 24 - 12, 3)) / 2);
  for (float& value : values) value = std::max(value, -1.5f);
  const DistanceField field = DistanceField::from_dense(grid, 1.5, values);
  ASSERT_EQ(field.background(0, 0, 0), -1.5f);
  const FieldSummary found = inspect(field);
  EXPECT_EQ(found.min, -1.5);
  EXPECT_EQ(found.max, 1.5);
  EXPECT_EQ(found.band, 5 * 64) << "-1 to 1 in steps of a half";
}

TEST(Inspect, ValuesThatAreNoNumberAreCounted) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const std::vector<float> values{nan, 1, -3, 2, 4, 4, nan, 0.5f};
  const FieldSummary found = inspect(DistanceField::from_dense({{2, 2, 2}}, 4, values));
  EXPECT_EQ(found.nan, 2);
  EXPECT_EQ(found.min, -3);
  EXPECT_EQ(found.max, 4);
  EXPECT_EQ(found.band, 4) << "a value that equals the thickness may have been clamped";
  const FieldSummary none = inspect(DistanceField::from_dense({{1, 1, 1}}, 4, std::vector<float>{nan}));
  EXPECT_EQ(none.nan, 1);
  EXPECT_EQ(none.min, kInfinity);
  EXPECT_EQ(none.max, -kInfinity);
}

// A slice of all samples was made, and each of them looked at: half a minute for a file of 12 kB.
TEST(Inspect, TilesThatAreNotStoredTakeNoMemory) {
  const DistanceField field({{1 << 12, 1 << 12, 1}, {}, {1, 1, 1}}, 3);
  FieldSummary found;
  EXPECT_EQ(testing::heap::most_held([&] { found = inspect(field); }), 0);
  EXPECT_EQ(found.min, 3);
  EXPECT_EQ(found.max, 3);
  EXPECT_EQ(found.band, 0);
}

// One sample of the last tile is in the grid; what lies beyond counts for nothing.
TEST(Inspect, SamplesBeyondTheGridDoNotCount) {
  DistanceField field({{9, 9, 9}, {}, {1, 1, 1}}, 3, true);
  std::ranges::fill(field.store_tile(1, 1, 1), 2.0f);
  std::ranges::fill(field.store_nearest(1, 1, 1), 7u);
  field.mark_inside(0, 0, 0);
  const FieldSummary found = inspect(field);
  EXPECT_EQ(found.min, -3);
  EXPECT_EQ(found.max, 3);
  EXPECT_EQ(found.band, 1);
}

}  // namespace
}  // namespace standoff
