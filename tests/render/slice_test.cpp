// SPDX-License-Identifier: Apache-2.0
#include "standoff/slice.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <limits>

#include "render/colormap.h"
#include "render/legend.h"
#include "render/slice_picture.h"
#include "tests/io/field/odd_field.h"
#include "tests/support/comma_locale.h"
#include "tests/support/expect_error.h"
#include "tests/support/paths.h"
#include "tests/support/temp_folder.h"

namespace standoff {
namespace {

constexpr Color kGrey{178, 178, 178};

// The color of the sample that is `right` and `up` from the plane's lower left one.
Color sample(const SlicePicture& picture, const Plane& plane, std::int64_t right, std::int64_t up) {
  const auto x = (2 * right + 1) * picture.width / (2 * plane.width);
  const auto y = picture.height - 1 - (2 * up + 1) * picture.height / (2 * plane.height);
  return picture.image.at(picture.left + static_cast<int>(x), picture.top + static_cast<int>(y));
}

// Every sample of a slice must have the color of its value, here by value() alone.
void expect_colors(const DistanceField& field, const SliceOptions& options,
                   const std::function<float(std::int64_t, std::int64_t)>& value) {
  const SlicePicture picture = draw_slice(field, options);
  const Plane plane = plane_of(field, options);
  float least = std::numeric_limits<float>::infinity(), greatest = -least;
  for (std::int64_t u = 0; u < plane.height; ++u)
    for (std::int64_t r = 0; r < plane.width; ++r) {
      least = std::min(least, value(r, u));
      greatest = std::max(greatest, value(r, u));
    }
  for (std::int64_t u = 0; u < plane.height; ++u)
    for (std::int64_t r = 0; r < plane.width; ++r) {
      const double share = (static_cast<double>(value(r, u)) - least) / (static_cast<double>(greatest) - least);
      EXPECT_EQ(sample(picture, plane, r, u), color_of(options.colormap, share)) << r << "," << u;
    }
}

TEST(Slice, EverySampleHasItsPlaceAndColor) {
  const DistanceField field = odd_field();
  for (const Colormap map : {Colormap::viridis, Colormap::thesis}) {
    SliceOptions options{Axis::z, 0.5, std::nullopt, map, 512};
    expect_colors(field, options, [&](auto r, auto u) { return field.value(r, u, 10); });
    options.axis = Axis::y;
    expect_colors(field, options, [&](auto r, auto u) { return field.value(r, 4, u); });
    options.axis = Axis::x;
    expect_colors(field, options, [&](auto r, auto u) { return field.value(5, r, u); });
    options.index = 10;
    expect_colors(field, options, [&](auto r, auto u) { return field.value(10, r, u); });
  }
}

TEST(Slice, EndsOfTheColormapsAreEndsOfTheValues) {
  SliceOptions options;
  const Plane plane = plane_of(odd_field(), options);
  SlicePicture picture = draw_slice(odd_field(), options);
  EXPECT_EQ(sample(picture, plane, 0, 0), (Color{68, 1, 84}));
  EXPECT_EQ(sample(picture, plane, 10, 8), (Color{253, 231, 37}));
  options.colormap = Colormap::thesis;
  picture = draw_slice(odd_field(), options);
  EXPECT_EQ(sample(picture, plane, 0, 0), (Color{255, 0, 0}));
  EXPECT_EQ(sample(picture, plane, 10, 8), (Color{0, 0, 255}));
}

TEST(Slice, PlacesRoundToTheNearestSample) {
  const DistanceField field = odd_field();
  const auto index = [&](Axis axis, double at) {
    SliceOptions options;
    options.axis = axis;
    options.at = at;
    return plane_of(field, options).index;
  };
  EXPECT_EQ(index(Axis::z, 0), 0);
  EXPECT_EQ(index(Axis::z, 1), 20);
  EXPECT_EQ(index(Axis::z, 0.26), 5);
  EXPECT_EQ(index(Axis::z, 0.28), 6);
  EXPECT_EQ(index(Axis::x, 1), 10);
  EXPECT_EQ(index(Axis::y, 1), 8);
  SliceOptions options;
  options.index = 3;
  EXPECT_EQ(plane_of(field, options).position, 1e6 + 6);
  EXPECT_EQ(index(Axis::z, 0.5), 10);
}

TEST(Slice, SidesAreEnlargedByWholeFactorsAndTrueToSpace) {
  const auto size = [](Size3 samples, Vec3 spacing, int pixels = 512) {
    SliceOptions options;
    options.pixels = pixels;
    const SlicePicture picture = draw_slice(DistanceField({samples, {}, spacing}, 1), options);
    return std::pair(picture.width, picture.height);
  };
  EXPECT_EQ(size({128, 128, 1}, {1, 1, 1}), std::pair(512, 512));
  EXPECT_EQ(size({100, 50, 1}, {2, 2, 2}), std::pair(600, 300));
  EXPECT_EQ(size({600, 50, 1}, {1, 1, 1}), std::pair(600, 50));
  EXPECT_EQ(size({64, 64, 1}, {1, 2, 9}), std::pair(256, 512));
  EXPECT_EQ(size({10, 30, 1}, {1, 0.25, 9}, 40), std::pair(40, 30));
  EXPECT_EQ(size({1, 1, 1}, {1, 1, 1}, 1), std::pair(1, 1));
  // Too long for a picture: thinned, and never to nothing.
  EXPECT_EQ(size({9000, 10, 1}, {1, 1, 1}), std::pair(8192, 9));
  EXPECT_EQ(size({100, 1, 1}, {1e9, 1, 1}), std::pair(8192, 1));
}

TEST(Slice, InfiniteValuesAreGrey) {
  // Tiles from x = 8 on are absent: infinite.
  DistanceField field({{16, 8, 1}, {}, {1, 1, 1}}, kInfinite);
  const auto tile = field.store_tile(0, 0, 0);
  for (int n = 0; n < DistanceField::kTileSamples; ++n) tile[n] = static_cast<float>(n % 8);
  const Plane plane = plane_of(field, {});
  const SlicePicture picture = draw_slice(field, {});
  EXPECT_EQ(sample(picture, plane, 0, 0), (Color{68, 1, 84}));
  EXPECT_EQ(sample(picture, plane, 7, 7), (Color{253, 231, 37}));
  EXPECT_EQ(sample(picture, plane, 8, 0), kGrey);
  const SlicePicture nothing = draw_slice(DistanceField({{16, 8, 1}, {}, {1, 1, 1}}, kInfinite), {});
  EXPECT_EQ(sample(nothing, plane, 0, 0), kGrey);
  // Without finite values there is no legend beside the plane.
  EXPECT_LT(nothing.image.width, picture.image.width);
}

TEST(Slice, ConstantPlanesHaveOneColor) {
  const DistanceField field({{4, 4, 1}, {}, {1, 1, 1}}, 3);
  EXPECT_EQ(sample(draw_slice(field, {}), plane_of(field, {}), 2, 2), (Color{68, 1, 84}));
}

TEST(Slice, TheLegendShowsTheColorsBesideThePlane) {
  const SlicePicture picture = draw_slice(odd_field(), {});
  const Image& image = picture.image;
  const int bar = picture.left + picture.width + 28 + 12;
  EXPECT_EQ(image.at(bar, picture.top), color_of(Colormap::viridis, 1 - 0.5 / picture.height));
  EXPECT_EQ(image.at(bar, picture.top + picture.height - 1), color_of(Colormap::viridis, 0.5 / picture.height));
  EXPECT_EQ(image.at(bar, picture.top + picture.height / 4), color_of(Colormap::viridis, 0.75));
  // Numbers stand beside both ends, and words above the plane.
  const auto has_ink = [&](int left, int top, int right, int bottom) {
    for (int y = top; y < bottom; ++y)
      for (int x = left; x < right; ++x)
        if (image.at(x, y)[0] < 120) return true;
    return false;
  };
  EXPECT_TRUE(has_ink(bar + 22, picture.top, image.width, picture.top + 14));
  EXPECT_TRUE(has_ink(bar + 22, picture.top + picture.height - 14, image.width, picture.top + picture.height));
  EXPECT_TRUE(has_ink(20, 20, 200, 34));
  EXPECT_FALSE(has_ink(0, 0, 20, image.height));
  EXPECT_FALSE(has_ink(image.width - 20, 0, image.width, image.height));
}

TEST(Legend, CopesWithAnyRange) {
  constexpr double kLargest = std::numeric_limits<float>::max(), kTiny = std::numeric_limits<float>::denorm_min();
  const std::vector<std::pair<double, double>> ranges{
      {0, 1}, {0, kLargest}, {-kLargest, kLargest}, {0, kTiny},          {1e6, 1e6 + 0.1}, {-3, -2},
      {0, 0}, {5, 5},        {-1e-20, 1e20},        {16777215, 16777216}};
  for (const auto& [least, greatest] : ranges) {
    const Legend legend(least, greatest, kInfinite, Colormap::viridis);
    Image image(legend.width(), 300, {255, 255, 255});
    legend.draw(image, 0, 0, 300);
    EXPECT_LT(legend.width(), 400);
    EXPECT_EQ(legend.color(least), (Color{68, 1, 84}));
    if (greatest > least) {
      EXPECT_EQ(legend.color(greatest), (Color{253, 231, 37}));
    }
    EXPECT_EQ(legend.color(kInfinite), kGrey);
  }
  // What is clamped says so.
  const auto width = [](double thickness) { return Legend(-2, 2, thickness, Colormap::viridis).width(); };
  EXPECT_GT(width(2), width(3));
  EXPECT_GT(Legend(-2, 1, 2, Colormap::viridis).width(), Legend(-2, 1, 3, Colormap::viridis).width()) << "inside";
}

TEST(Legend, NumbersAreShort) {
  EXPECT_EQ(short_text(-0.0, 4), "0");
  EXPECT_EQ(short_text(0.30000000000000004, 4), "0.3");
  EXPECT_EQ(short_text(1234567, 4), "1.235e+06");
}

// "0,30" stood beside the colours where the program that draws had set such a locale.
TEST(Legend, NumbersDoNotFollowTheLocale) {
  const CommaLocale locale;
  if (!locale.is_set()) GTEST_SKIP() << "no localedef here";
  EXPECT_EQ(short_text(0.3, 4), "0.3");
  EXPECT_EQ(short_text(1234567, 4), "1.235e+06");
  EXPECT_EQ(short_text(12345, 6), "12345");
}

TEST(Slice, OptionsOutOfRangeAreRefused) {
  const auto refused = [](auto change, const std::string& words) {
    SliceOptions options;
    change(options);
    expect_error([&] { draw_slice(odd_field(), options); }, ErrorCode::usage, words);
  };
  refused([](auto& o) { o.at = -0.1; }, "the place must be 0 (the first sample) to 1 (the last)");
  refused([](auto& o) { o.at = 1.1; }, "the place must be 0");
  refused([](auto& o) { o.at = std::numeric_limits<double>::quiet_NaN(); }, "the place must be 0");
  refused([](auto& o) { o.index = -1; }, "sample -1 is outside the field, which has 21 along that axis");
  refused([](auto& o) { o.index = 21; }, "sample 21 is outside the field, which has 21 along that axis");
  refused([](auto& o) { o.pixels = 0; }, "the picture's size must be 1 to 8192 pixels");
  refused([](auto& o) { o.pixels = 8193; }, "the picture's size must be 1 to 8192 pixels");
}

// VTK sees the size and the colors of the picture's corners that we drew.
TEST(Slice, BecomesAFileThatOthersRead) {
  const TempFolder folder;
  try {
    require_png();
  } catch (const Error&) {
    expect_error([&] { write_slice_png(folder / "a.png", odd_field()); }, ErrorCode::usage, "pictures need libpng");
    GTEST_SKIP() << "built without libpng";
  }
  write_slice_png(folder / "a.png", odd_field());
  const SlicePicture picture = draw_slice(odd_field(), {});
  const int x = picture.left + 3, y = picture.top + picture.height - 3;
  const std::string command = std::string(kPython) +
                              " -B -c 'import sys; from vtkmodules.vtkIOImage import vtkPNGReader; r = vtkPNGReader(); "
                              "r.SetFileName(sys.argv[1]); r.Update(); i = r.GetOutput(); w, h, _ = i.GetDimensions(); "
                              "x, y = int(sys.argv[4]), h - 1 - int(sys.argv[5]); "
                              "sys.exit([w, h] != [int(a) for a in sys.argv[2:4]] or "
                              "[i.GetScalarComponentAsDouble(x, y, 0, c) for c in range(3)] != [68, 1, 84])' '" +
                              (folder / "a.png").string() + "' " + std::to_string(picture.image.width) + " " +
                              std::to_string(picture.image.height) + " " + std::to_string(x) + " " + std::to_string(y);
  EXPECT_EQ(std::system(command.c_str()), 0) << command;
  expect_error([&] { write_slice_png(folder / "no/a.png", odd_field()); }, ErrorCode::output,
               "does not exist; create it first");
  EXPECT_EQ(folder.names(), std::set<std::string>{"a.png"});
}

}  // namespace
}  // namespace standoff
