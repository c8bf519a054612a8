// SPDX-License-Identifier: Apache-2.0
#include "render/raster.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>

namespace standoff {
namespace {

constexpr Color kPaper{255, 255, 255}, kRed{255, 0, 0}, kBlue{0, 0, 255};

ScreenPoint at(double x, double y, float depth = 0) {
  return {static_cast<std::int32_t>(x * kSubpixels), static_cast<std::int32_t>(y * kSubpixels), depth};
}

std::int64_t count(const Raster& raster, Color color) { return std::ranges::count(raster.image().pixels, color); }

TEST(Raster, FillsPixelsWhoseCentresLieInside) {
  Raster raster(6, 4, kPaper);
  raster.draw(at(1, 1), at(5, 1), at(1, 3), kRed);
  // Centres at half pixels below the slope from (5,1) to (1,3).
  const std::vector<std::string> expected{"......", ".###..", ".#....", "......"};
  for (int y = 0; y < 4; ++y)
    for (int x = 0; x < 6; ++x)
      EXPECT_EQ(raster.image().at(x, y), expected[y][x] == '#' ? kRed : kPaper) << x << "," << y;
}

TEST(Raster, DrawsBothWindingsAlike) {
  Raster one(50, 50, kPaper), other(50, 50, kPaper);
  one.draw(at(3, 4, 1), at(40, 11, 2), at(13, 45, 3), kRed);
  other.draw(at(3, 4, 1), at(13, 45, 3), at(40, 11, 2), kRed);
  EXPECT_EQ(one.image().pixels, other.image().pixels);
  EXPECT_GT(count(one, kRed), 500);
}

TEST(Raster, NeighboursLeaveNoGap) {
  std::mt19937 random(3);
  Raster raster(64, 64, kPaper);
  // A fan around a point, its rim outside the picture: every pixel is inside one triangle or on an edge.
  const ScreenPoint middle = at(31.3, 29.7);
  std::vector<ScreenPoint> rim;
  for (int n = 0; n < 40; ++n) {
    const double turn = (n + 0.8 * static_cast<double>(random() % 100) / 100) / 40 * 6.283185307179586;
    rim.push_back(at(32 + 100 * std::cos(turn), 32 + 100 * std::sin(turn)));
  }
  for (std::size_t n = 0; n < rim.size(); ++n) raster.draw(middle, rim[n], rim[(n + 1) % rim.size()], kRed);
  EXPECT_EQ(count(raster, kRed), 64 * 64);
}

TEST(Raster, NearerTrianglesHideOthersInAnyOrder) {
  for (const bool near_first : {false, true}) {
    Raster raster(20, 20, kPaper);
    const auto near = [&] { raster.draw(at(0, 0, 2), at(20, 0, 2), at(0, 20, 2), kRed); };
    const auto far = [&] { raster.draw(at(0, 0, 1), at(40, 0, 1), at(0, 40, 1), kBlue); };
    if (near_first) near();
    far();
    if (!near_first) near();
    EXPECT_EQ(raster.image().at(2, 2), kRed);
    EXPECT_EQ(raster.image().at(18, 18), kBlue);
  }
}

TEST(Raster, DepthIsLinearOverATriangle) {
  Raster raster(100, 100, kPaper);
  // Crosses the constant depth 0.5 where x = 50.
  raster.draw(at(0, 0, 0.5f), at(200, 0, 0.5f), at(0, 200, 0.5f), kBlue);
  raster.draw(at(0, 0, 0), at(200, 0, 2), at(0, 200, 0), kRed);
  for (int x = 0; x < 100; ++x) EXPECT_EQ(raster.image().at(x, 30), x < 50 ? kBlue : kRed) << x;
  EXPECT_FLOAT_EQ(raster.depths()[30 * 100 + 80], 0.805f);
}

TEST(Raster, FirstDrawnWinsTies) {
  Raster raster(10, 10, kPaper);
  raster.draw(at(0, 0), at(20, 0), at(0, 20), kRed);
  raster.draw(at(0, 0), at(20, 0), at(0, 20), kBlue);
  EXPECT_EQ(count(raster, kBlue), 0);
}

TEST(Raster, DegenerateAndOutsideTrianglesDrawNothing) {
  Raster raster(10, 10, kPaper);
  raster.draw(at(1, 1), at(9, 9), at(5, 5), kRed);
  raster.draw(at(4.5, 4.5), at(4.5, 4.5), at(4.5, 4.5), kRed);
  raster.draw(at(-50, -50), at(-1, -50), at(-50, -1), kRed);
  raster.draw(at(11, 0), at(50, 0), at(50, 50), kRed);
  EXPECT_EQ(count(raster, kPaper), 100);
  EXPECT_EQ(raster.depths()[0], -std::numeric_limits<float>::infinity());
}

TEST(Raster, HugeTrianglesAreCut) {
  constexpr std::int32_t kFar = (1 << 30) - 1;
  Raster raster(10, 10, kPaper);
  raster.draw({-kFar, -kFar, 0}, {kFar, -kFar, 0}, {0, kFar, 0}, kRed);
  EXPECT_EQ(count(raster, kRed), 100);
}

TEST(Halved, AveragesFourPixels) {
  Image image(4, 2, {0, 0, 0});
  image.at(0, 0) = {255, 100, 1};
  image.at(1, 1) = {255, 101, 1};
  image.at(2, 0) = image.at(3, 0) = image.at(2, 1) = image.at(3, 1) = {9, 8, 7};
  const Image half = halved(image);
  ASSERT_EQ(half.width, 2);
  ASSERT_EQ(half.height, 1);
  EXPECT_EQ(half.at(0, 0), (Color{128, 50, 1}));
  EXPECT_EQ(half.at(1, 0), (Color{9, 8, 7}));
}

}  // namespace
}  // namespace standoff
