// SPDX-License-Identifier: Apache-2.0
#include "render/scales.h"

#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "render/image.h"

namespace standoff {
namespace {

constexpr Theme kLegendTheme = theme_of(Background::white);
constexpr Color kMiddle{247, 247, 247};
constexpr double kInfinite = std::numeric_limits<double>::infinity();

Legend legend_of(double least, double greatest, double thickness = kInfinite, Colormap map = Colormap::viridis) {
  return {least, greatest, thickness, map, kLegendTheme, "distance"};
}

Image drawn(const Legend& legend, int height = 401) {
  Image image(legend.width(1), height, kLegendTheme.paper);
  legend.draw(image, 0, 0, height, 1);
  return image;
}

// The rows of a column that have a color, first and last.
std::pair<int, int> rows_of(const Image& image, int x, const Color& color) {
  int first = -1, last = -1;
  for (int y = 0; y < image.height; ++y)
    if (image.at(x, y) == color) {
      if (first < 0) first = y;
      last = y;
    }
  return {first, last};
}

TEST(Legend, TheBarHasTheColorsOfTheValues) {
  const Image image = drawn(legend_of(0, 1));
  // Below the heading: 377 rows.
  for (const int row : {0, 100, 188, 300, 376})
    EXPECT_EQ(image.at(5, 24 + row), color_of(Colormap::viridis, 1 - (row + 0.5) / 377)) << row;
}

TEST(Legend, GreyEndsStandForWhatIsBeyond) {
  const Legend both = legend_of(-2, 2, 2, Colormap::diverging);
  EXPECT_EQ(both.color(2), kLegendTheme.outside);
  EXPECT_EQ(both.color(-2), kLegendTheme.inside);
  EXPECT_EQ(both.color(kInfinite), kLegendTheme.outside);
  EXPECT_EQ(both.color(-kInfinite), kLegendTheme.inside);
  EXPECT_EQ(both.color(std::numeric_limits<double>::quiet_NaN()), kLegendTheme.nothing);
  const Image image = drawn(both);
  EXPECT_EQ(rows_of(image, 5, kLegendTheme.outside), std::pair(24, 37));
  EXPECT_EQ(rows_of(image, 5, kLegendTheme.inside), std::pair(387, 400));
  EXPECT_EQ(image.at(5, 39), kLegendTheme.paper) << "set apart from the bar";
  // Only where there are such values.
  const Image inner = drawn(legend_of(-1, 1, 2, Colormap::diverging));
  EXPECT_EQ(rows_of(inner, 5, kLegendTheme.outside).first, -1);
  EXPECT_EQ(rows_of(inner, 5, kLegendTheme.inside).first, -1);
}

TEST(Legend, DivergingColorsPartAtZero) {
  const Legend legend = legend_of(-1, 3, 10, Colormap::diverging);
  EXPECT_EQ(legend.color(0), kMiddle);
  EXPECT_EQ(legend.color(3), color_of(Colormap::diverging, 1));
  EXPECT_EQ(legend.color(-1), color_of(Colormap::diverging, 0.5 - 0.5 / 3)) << "as dark as 1 is";
  EXPECT_EQ(legend_of(0, 0, 2, Colormap::diverging).color(0), kMiddle);
  const Image image = drawn(legend);
  EXPECT_EQ(image.at(3, 24 + 377 * 3 / 4), kMiddle) << "0 is a quarter up";
}

TEST(Legend, NumbersAreRoundAndBetweenTheEnds) {
  std::vector<double> values;
  const Legend legend = legend_of(-0.049, 0.05, 0.05);
  for (const Tick& tick : legend.ticks()) values.push_back(tick.value);
  EXPECT_EQ(values, (std::vector<double>{-0.04, -0.02, 0, 0.02, 0.04}));
}

TEST(Legend, CopesWithAnyRange) {
  constexpr double kLargest = std::numeric_limits<float>::max(), kTiny = std::numeric_limits<float>::denorm_min();
  const std::vector<std::pair<double, double>> ranges{
      {0, 1}, {0, kLargest}, {-kLargest, kLargest}, {0, kTiny},          {1e6, 1e6 + 0.1}, {-3, -2},
      {0, 0}, {5, 5},        {-1e-20, 1e20},        {16777215, 16777216}};
  for (const auto& [least, greatest] : ranges)
    for (const double thickness : {kInfinite, greatest}) {
      if (thickness == 0) continue;
      const Legend legend = legend_of(least, greatest, thickness);
      for (const int height : {300, 60, 20}) drawn(legend, height);
      EXPECT_LT(legend.width(1), 250);
      if (thickness < kInfinite) continue;
      EXPECT_EQ(legend.color(least), (Color{68, 1, 84}));
      if (greatest > least) {
        EXPECT_EQ(legend.color(greatest), (Color{253, 231, 37}));
      }
    }
}

TEST(Legend, WidthHoldsAllWords) {
  for (const double scale : {1.0, 2.5}) {
    const Legend legend = legend_of(-1234.5, 0.25, 1234.5);
    const int width = legend.width(scale);
    Image image(width + 50, 600, kLegendTheme.paper);
    legend.draw(image, 0, 0, 600, scale);
    for (int y = 0; y < image.height; ++y)
      for (int x = width + 1; x < image.width; ++x) ASSERT_EQ(image.at(x, y), kLegendTheme.paper) << x << ", " << y;
  }
}

}  // namespace
}  // namespace standoff
