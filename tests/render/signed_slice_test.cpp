// SPDX-License-Identifier: Apache-2.0
// Slices of signed fields: colours that part at 0, and the line there.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "render/image.h"
#include "render/scales.h"
#include "render/slice.h"

namespace standoff {
namespace {

constexpr float kInf = std::numeric_limits<float>::infinity();
constexpr Color kWhite{247, 247, 247};

// Samples of a function of right and up, from 0 on.
template <class Value>
Plane plane_of_values(std::int64_t width, std::int64_t height, const Value& value) {
  Plane plane;
  plane.width = width;
  plane.height = height;
  for (std::int64_t u = 0; u < height; ++u)
    for (std::int64_t r = 0; r < width; ++r)
      plane.values.push_back(static_cast<float>(value(static_cast<double>(r), static_cast<double>(u))));
  return plane;
}

std::vector<float> zero_line(const Plane& plane, int width, int height, double line_width = 1) {
  return level_line(interpolated(plane, width, height), width, height, 0, line_width);
}

double sum(const std::vector<float>& covered) { return std::accumulate(covered.begin(), covered.end(), 0.0); }

TEST(ZeroLine, IsOnePixelWideAndWhereItBelongs) {
  // Upright, between two columns of pixels' centres: sample r's square has pixels 10 r to 10 r + 9, so its centre is at
  // 10 r + 5, and the pixel's at x + 0.5. The line is at r = 2.37, which is 28.7: between centres 28.5 and 29.5.
  const Plane upright = plane_of_values(5, 4, [](auto r, auto) { return r - 2.37; });
  const std::vector<float> covered = zero_line(upright, 50, 40);
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 50; ++x) {
      const double expected = x == 28 ? 0.8 : x == 29 ? 0.2 : 0;
      ASSERT_NEAR(covered[50 * y + x], expected, 1e-4) << x << ", " << y;
    }
  // Upwards is up: u = 0.3 is at 8 from below.
  const Plane level = plane_of_values(5, 4, [](auto, auto u) { return u - 0.3; });
  const std::vector<float> rows = zero_line(level, 50, 40);
  for (int y = 0; y < 40; ++y) ASSERT_NEAR(rows[50 * y + 7], y == 31 || y == 32 ? 0.5 : 0, 1e-4) << y;
}

// The ink of a line is its length, whichever way it runs.
TEST(ZeroLine, HasTheLengthOfTheCurve) {
  for (const double angle : {0.0, 0.2, 0.6, 0.7853981, 1.2, 2.5}) {
    const Plane plane =
        plane_of_values(9, 9, [&](auto r, auto u) { return std::cos(angle) * (r - 4) + std::sin(angle) * (u - 4); });
    const double length = 360 / std::max(std::abs(std::cos(angle)), std::abs(std::sin(angle)));
    // The outermost half squares repeat their samples. Pixels are as dark as they are near, not by their area in the
    // line: at 45 degrees that makes a tenth.
    EXPECT_NEAR(sum(zero_line(plane, 360, 360)) / length, 1, 0.12) << angle;
    EXPECT_NEAR(sum(zero_line(plane, 360, 360, 2)) / length, 1.95, 0.15) << angle;
  }
  const Plane circle = plane_of_values(101, 101, [](auto r, auto u) { return std::hypot(r - 50.0, u - 50.0) - 30; });
  EXPECT_NEAR(sum(zero_line(circle, 404, 404)) / (2 * 3.14159265 * 120), 1, 0.06);
  EXPECT_NEAR(sum(zero_line(circle, 50, 50)) / (2 * 3.14159265 * 30 * 50 / 101), 1, 0.1) << "fewer pixels than samples";
}

TEST(ZeroLine, OnlyWhereTheSignChanges) {
  const auto ink = [](auto value) { return sum(zero_line(plane_of_values(6, 6, value), 60, 60)); };
  EXPECT_EQ(ink([](auto r, auto) { return std::abs(r - 3.0); }), 0) << "it touches 0";
  EXPECT_EQ(ink([](auto r, auto) { return r < 3 ? -1 : -2; }), 0);
  EXPECT_EQ(ink([](auto, auto) { return 0; }), 0);
  EXPECT_EQ(ink([](auto r, auto) { return r < 3 ? -kInf : kInf; }), 0);
  EXPECT_NEAR(ink([](auto r, auto) { return r < 3 ? -1 : 1; }), 60, 1e-3) << "clamped on both sides";
  EXPECT_NEAR(ink([](auto r, auto) { return r < 3 ? -1 : 0; }), 70, 20) << "0 is outside";
  EXPECT_EQ(sum(zero_line(plane_of_values(1, 1, [](auto, auto) { return -1; }), 1, 1)), 0);
}

// Samples of x + 0.3 y, clamped: the band ends on straight lines, whatever the squares of the samples.
TEST(BandEdge, IsWhereTheValuesWouldReachTheThickness) {
  const auto value = [](double r, double u) { return 0.8 * (r - 10) + 0.3 * (u - 10); };
  const Plane clamped = plane_of_values(21, 21, [&](auto r, auto u) { return std::clamp(value(r, u), -4.1, 4.1); });
  const float thickness = static_cast<float>(4.1);
  const Plane extended = beyond_band(clamped, thickness);
  int made_up = 0, exact = 0;
  for (std::int64_t u = 0; u < 21; ++u)
    for (std::int64_t r = 0; r < 21; ++r) {
      const float before = clamped.value(r, u), after = extended.value(r, u);
      if (std::abs(before) < thickness) {
        EXPECT_EQ(after, before) << r << ", " << u;
      }
      EXPECT_EQ(std::abs(after) >= thickness, std::abs(before) >= thickness) << r << ", " << u;
      if (after == before) continue;
      ++made_up;
      exact += std::abs(after - value(static_cast<double>(r), static_cast<double>(u))) < 1e-5;
    }
  // The others have only a diagonal neighbour in the band, or one sample of it before the plane's edge.
  EXPECT_GT(exact, made_up * 2 / 3);
  EXPECT_GT(made_up, 40);
  // Nothing is clamped, and no number is finite.
  const Plane free = plane_of_values(5, 4, [](auto r, auto) { return r < 2 ? kInf : r; });
  EXPECT_EQ(beyond_band(free, kInf).values, free.values);
}

// Relative luminance to lightness (CIE 1976).
double lightness(const Color& color) {
  const auto linear = [](std::uint8_t c) {
    const double s = c / 255.0;
    return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
  };
  return 116 * std::cbrt(0.2126 * linear(color[0]) + 0.7152 * linear(color[1]) + 0.0722 * linear(color[2])) - 16;
}

TEST(SignedColors, BlueInsideRedOutsideEquallyDark) {
  for (int n = 1; n <= 100; ++n) {
    const Color in = color_of(Colormap::diverging, 0.5 - n / 200.0),
                out = color_of(Colormap::diverging, 0.5 + n / 200.0);
    const Color before = color_of(Colormap::diverging, 0.5 + (n - 1) / 200.0);
    EXPECT_GT(in[2], in[0]) << n;
    EXPECT_GT(out[0], out[2]) << n;
    EXPECT_NEAR(lightness(in), lightness(out), 6) << n;
    EXPECT_LT(lightness(out), lightness(before) + 0.01) << n;
  }
  EXPECT_EQ(color_of(Colormap::diverging, 0.5), kWhite);
}

// Not clamped anywhere: its values are from `least` at the middle on.
DistanceField ball(float least) {
  std::vector<float> values;
  for (int y = 0; y < 25; ++y)
    for (int x = 0; x < 25; ++x) values.push_back(least + static_cast<float>(std::hypot(x - 12, y - 12)));
  return DistanceField::from_dense({{25, 25, 1}, {}, {1, 1, 1}}, kInf, values);
}

TEST(SignedSlice, AutomaticTakesDivergingColorsWhereThereIsASign) {
  const auto centre = [](const DistanceField& field, Colormap map) {
    SliceOptions options;
    options.axis = Axis::z;
    options.colormap = map;
    options.interpolation = Interpolation::nearest;
    const SlicePicture picture = draw_slice(field, options);
    return picture.image.at(picture.left + picture.width / 2, picture.top + picture.height / 2);
  };
  EXPECT_EQ(centre(ball(-9), Colormap::viridis), color_of(Colormap::viridis, 0));
  EXPECT_EQ(centre(ball(-9), Colormap::thesis), color_of(Colormap::thesis, 0));
  const double greatest = static_cast<float>(std::hypot(12, 12)) - 9;
  EXPECT_EQ(centre(ball(-9), Colormap::automatic),
            color_of(Colormap::diverging, 0.5 - 0.5 * 9 / std::max(9.0, greatest)));
  EXPECT_EQ(centre(ball(1), Colormap::automatic), color_of(Colormap::viridis, 0));
  DistanceField outside = ball(0);
  outside.set_provenance({"tiles", 1, "1", "winding"});
  EXPECT_EQ(centre(outside, Colormap::automatic), kWhite) << "signed, and nothing inside";
  // No tile is stored: all is beyond the band, and the sign shows all the same.
  DistanceField deep({{8, 8, 1}, {}, {1, 1, 1}}, 4);
  EXPECT_EQ(centre(deep, Colormap::automatic), theme_of(Background::white).outside);
  deep.mark_inside(0, 0, 0);
  EXPECT_EQ(centre(deep, Colormap::automatic), theme_of(Background::white).inside);
}

TEST(SignedSlice, TheLineIsDrawnOverTheColors) {
  std::vector<float> values;
  for (int n = 0; n < 24 * 24; ++n) values.push_back(static_cast<float>(n % 24) - 20.5f);
  const auto field = DistanceField::from_dense({{24, 24, 1}, {}, {1, 1, 1}}, 30, values);
  for (const Colormap map : {Colormap::diverging, Colormap::viridis}) {
    SliceOptions options;
    options.axis = Axis::z;
    options.colormap = map;
    const SlicePicture picture = draw_slice(field, options);
    // Samples of 22 pixels, the line in the middle between 20 and 21, 0.9 pixels to each side.
    const Color ink{20, 22, 28};
    const Legend legend(-20.5, 2.5, 30, map, theme_of(Background::white), "");
    const int y = picture.top + picture.height / 2 - 1;
    for (const int sample : {20, 21}) {
      const Color color = legend.color(sample - 20.5);
      const int x = picture.left + (sample == 20 ? 461 : 462);
      for (std::size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(picture.image.at(x, y)[c], color[c] * 0.1 + ink[c] * 0.9, 1) << sample << ", " << c;
    }
  }
}

}  // namespace
}  // namespace standoff
