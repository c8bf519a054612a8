// SPDX-License-Identifier: Apache-2.0
#include "standoff/grid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "standoff/thesis.h"
#include "tests/support/expect_error.h"

namespace standoff {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN(), kInfinite = std::numeric_limits<double>::infinity();
const Box kBox{{-1, 2, 3}, {3, 3, 5}};

constexpr Padding kNone{.least_samples = 0};
Padding by_length(double by) { return {.length = by, .least_samples = 0}; }

void expect_covers(const Grid& grid, const Box& box) {
  const Box covered = grid.bounds();
  const double slack = 1e-9 * grid.max_spacing();
  for (const double gap : {box.min.x - covered.min.x, box.min.y - covered.min.y, box.min.z - covered.min.z,
                           covered.max.x - box.max.x, covered.max.y - box.max.y, covered.max.z - box.max.z}) {
    EXPECT_GE(gap, -slack);
    EXPECT_LE(gap, grid.max_spacing() / 2 + slack) << "half a cell at most on each side";
  }
}

TEST(Grid, FitSamplesPutsThemOnTheLongestSide) {
  const Grid grid = fit_resolution(kBox, 41, kNone);
  EXPECT_EQ(grid.size, (Size3{41, 11, 21}));
  EXPECT_DOUBLE_EQ(grid.spacing.x, 0.1);
  expect_covers(grid, kBox);
  EXPECT_EQ(fit_resolution(kBox).size.x, kDefaultResolution);
  expect_covers(fit_resolution(kBox, 37, by_length(0.5)), kBox.grown(0.5));
  EXPECT_EQ(fit_resolution({{1, 2, 3}, {1, 2, 3}}, 10, kNone), (Grid{{1, 1, 1}, {1, 2, 3}, {1, 1, 1}}));
}

TEST(Grid, FittingLeavesRoomForTheBand) {
  for (const double thickness : {0.3, 0.4, 1.0, 5.0}) {
    // A tenth of the longest side at the most.
    const Box band = kBox.grown(std::min(thickness, 0.4));
    expect_covers(fit_resolution(kBox, 41, thickness), band);
    expect_covers(fit_spacing(kBox, {0.1, 0.1, 0.1}, thickness), band);
    EXPECT_EQ(fit_size(kBox, {41, 21, 31}, thickness), fit_size(band, {41, 21, 31}, kNone));
  }
}

TEST(Grid, FittingLeavesTwoSamplesAtLeast) {
  for (const double thickness : {1e-6, kInfinite}) {
    const Grid grid = fit_resolution(kBox, 41, thickness);
    EXPECT_EQ(grid.size.x, 41);
    EXPECT_NEAR(grid.spacing.x, 4.0 / 36, 1e-12) << "two cells of 40 on each side";
    expect_covers(grid, kBox.grown(2 * grid.spacing.x));
    expect_covers(fit_spacing(kBox, {0.1, 0.2, 0.3}, thickness),
                  {kBox.min - Vec3{0.2, 0.4, 0.6}, kBox.max + Vec3{0.2, 0.4, 0.6}});
    EXPECT_NEAR(fit_size(kBox, {41, 21, 31}, thickness).spacing.y, 1.0 / 16, 1e-12);
  }
  EXPECT_EQ(fit_resolution(kBox, 41), fit_resolution(kBox, 41, kInfinite)) << "a full field, unless told otherwise";
  // Small grids have fewer to give.
  EXPECT_NEAR(fit_resolution(kBox, 3).spacing.x, 4, 1e-12);
  EXPECT_EQ(fit_resolution(kBox, 2).size.x, 2);
  EXPECT_EQ(fit_resolution({{1, 2, 3}, {1, 2, 3}}, 10).size, (Size3{10, 10, 10})) << "a point";
}

TEST(Grid, PaddingInSamplesAndAsAShare) {
  EXPECT_EQ(fit_resolution(kBox, 41, padding_for_samples(3)), fit_resolution(kBox, 41, {.samples = 3}));
  EXPECT_EQ(fit_resolution(kBox, 41, padding_for_samples(9)), fit_resolution(kBox, 41, by_length(0.4)));
  EXPECT_EQ(fit_resolution(kBox, 41, padding_for_samples(kInfinite)), fit_resolution(kBox, 41, kInfinite));
  const Grid grid = fit_resolution(kBox, 41, {.samples = 5});
  EXPECT_NEAR(grid.spacing.x, 4.0 / 30, 1e-12);
  expect_covers(fit_resolution(kBox, 41, {.length = 3, .most_share = 0.25}), kBox.grown(1));
  expect_covers(fit_spacing(kBox, {0.1, 0.2, 0.3}, {.samples = 5}),
                {kBox.min - Vec3{0.5, 1, 1.5}, kBox.max + Vec3{0.5, 1, 1.5}});
  EXPECT_EQ(fit_resolution(kBox, 41, {.length = 0.5, .samples = 5}), fit_resolution(kBox, 41, {.samples = 5}));
}

TEST(Grid, FitSpacingCoversTheBox) {
  for (const Vec3 spacing : {Vec3{0.1, 0.1, 0.1}, Vec3{0.3, 0.7, 0.11}, Vec3{9, 9, 9}}) {
    const Grid grid = fit_spacing(kBox, spacing, by_length(0.25));
    EXPECT_EQ(grid.spacing, spacing);
    const Box covered = grid.bounds(), box = kBox.grown(0.25);
    EXPECT_LE(covered.min.x, box.min.x + 1e-9);
    EXPECT_GE(covered.max.z, box.max.z - 1e-9);
    EXPECT_LT(covered.extent().x, box.extent().x + spacing.x);
  }
}

TEST(Grid, FitSizeTakesTheSizeAsItIs) {
  const Grid grid = fit_size(kBox, {5, 3, 1}, kNone);
  EXPECT_EQ(grid, (Grid{{5, 3, 1}, {-1, 2, 4}, {1, 0.5, 1}}));
  EXPECT_EQ(fit_size({{0, 0, 2}, {4, 2, 2}}, {3, 3, 5}, kNone).spacing, (Vec3{2, 1, 2}))
      << "no extent: the largest of the others";
}

TEST(Grid, MinimumGridIsTheThesiss) {
  // (max - min) / thickness * e samples per axis, the box grown by the thickness.
  EXPECT_EQ(minimum_grid(kBox, 1, 2).size, (Size3{12, 6, 8}));
  EXPECT_EQ(minimum_grid(kBox, 0.5, 3).size, (Size3{30, 12, 18}));
  EXPECT_EQ(minimum_grid(kBox, 1, 2, 0.5).size, (Size3{18, 9, 12})) << "a fast body makes it finer";
  EXPECT_EQ(minimum_grid(kBox, 1e6, 1).size, (Size3{3, 3, 3})) << "2.000004 rounded up";
  const Box covered = minimum_grid(kBox, 1, 2).bounds(), grown = kBox.grown(1);
  EXPECT_NEAR(length(covered.min - grown.min) + length(covered.max - grown.max), 0, 1e-12);
}

TEST(Grid, HelpersSayWhatIsWrong) {
  const auto usage = ErrorCode::usage;
  expect_error([] { fit_resolution(kBox, 1); }, usage, "at least 2 samples");
  expect_error([] { fit_resolution(Box{}, 9); }, usage, "empty");
  expect_error([] { fit_resolution({{0, 0, 0}, {kInfinite, 1, 1}}, 9); }, usage, "too large");
  for (const double x : {-1.0, kNaN, kInfinite})
    for (const Padding& padding :
         {by_length(x), Padding{.samples = x}, Padding{.least_samples = x}, Padding{.samples = 4, .least_samples = 0}})
      expect_error([&] { fit_resolution(kBox, 9, padding); }, usage, "padding");
  expect_error([&] { fit_resolution(kBox, 9, {.most_share = kNaN}); }, usage, "padding");
  for (const double t : {0.0, -1.0, kNaN}) expect_error([&] { fit_resolution(kBox, 9, t); }, usage, "thickness");
  for (const double h : {0.0, -1.0, kNaN, kInfinite})
    expect_error([&] { fit_spacing(kBox, {1, h, 1}); }, usage, "spacing");
  expect_error([] { fit_spacing(kBox, {1e-300, 1, 1}); }, ErrorCode::limit, "larger spacing");
  expect_error([] { minimum_grid(kBox, 1e-300); }, ErrorCode::limit, "larger thickness");
  expect_error([] { fit_size(kBox, {4, 0, 4}); }, usage, "at least one sample");
  for (const double t : {0.0, -1.0, kNaN, kInfinite}) expect_error([&] { minimum_grid(kBox, t); }, usage, "thickness");
  for (const double e : {0.5, kNaN, kInfinite}) expect_error([&] { minimum_grid(kBox, 1, e); }, usage, "factor e");
  for (const double s : {-0.1, kNaN, kInfinite}) expect_error([&] { minimum_grid(kBox, 1, 2, s); }, usage, "speed");
}

TEST(Grid, ValidateNamesWhatIsWrong) {
  const auto usage = ErrorCode::usage;
  EXPECT_NO_THROW(validate(Grid{{1, 1, 1}, {}, {1, 1, 1}}));
  expect_error([] { validate(Grid{{0, 1, 1}, {}, {1, 1, 1}}); }, usage, "at least one sample");
  expect_error([] { validate(Grid{{1, -5, 1}, {}, {1, 1, 1}}); }, usage, "at least one sample");
  const std::int64_t large = std::int64_t{1} << 40;
  expect_error([&] { validate(Grid{{large, large, 1}, {}, {1, 1, 1}}); }, ErrorCode::limit, "too many samples");
  expect_error([&] { validate(Grid{{large + 1, 1, 1}, {}, {1, 1, 1}}); }, ErrorCode::limit, "too many samples");
  for (const double h : {0.0, -1.0, kNaN, kInfinite})
    expect_error([&] { validate(Grid{{2, 2, 2}, {}, {1, 1, h}}); }, usage, "spacing");
  expect_error([] { validate(Grid{{2, 2, 2}, {0, kNaN, 0}, {1, 1, 1}}); }, usage, "finite");
  expect_error([] { validate(Grid{{9, 2, 2}, {}, {1e308, 1, 1}}); }, usage, "finite");
}

TEST(Grid, PositionsAndIndices) {
  const Grid grid{{4, 5, 6}, {1, 2, 3}, {0.5, 1, 2}};
  EXPECT_EQ(grid.position(1, 2, 3), (Vec3{1.5, 4, 9}));
  EXPECT_EQ(grid.index(1, 2, 3), 1 + 4 * (2 + 5 * 3));
  EXPECT_EQ(grid.sample_count(), 120);
  EXPECT_EQ(grid.max_spacing(), 2);
}

}  // namespace
}  // namespace standoff
