// SPDX-License-Identifier: Apache-2.0
#include "standoff/slice.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <set>

#include "render/image.h"
#include "render/scales.h"
#include "render/slice.h"
#include "tests/io/field/odd_field.h"
#include "tests/support/expect_error.h"
#include "tests/support/paths.h"
#include "tests/support/temp_folder.h"

namespace standoff {
namespace {

constexpr Theme kWhiteTheme = theme_of(Background::white);

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
    SliceOptions options;
    options.axis = Axis::z;
    options.at = 0.5;
    options.colormap = map;
    options.interpolation = Interpolation::nearest;
    options.contours = false;
    expect_colors(field, options, [&](auto r, auto u) { return field.value(r, u, 10); });
    options.axis = Axis::y;
    expect_colors(field, options, [&](auto r, auto u) { return field.value(r, 4, u); });
    options.axis = Axis::x;
    expect_colors(field, options, [&](auto r, auto u) { return field.value(5, r, u); });
    options.index = 10;
    expect_colors(field, options, [&](auto r, auto u) { return field.value(10, r, u); });
  }
}

// What points up in the mesh points up in the picture, where it lies in the plane.
TEST(Slice, TheUpAxisPointsUp) {
  DistanceField field = odd_field();
  SliceOptions options;
  options.colormap = Colormap::viridis;
  options.interpolation = Interpolation::nearest;
  options.contours = false;
  options.at = 0.5;
  for (const Axis axis : {Axis::x, Axis::y, Axis::z}) {
    options.axis = axis;
    const Plane usual = plane_of(field, options);
    for (const Axis up : {Axis::x, Axis::y, Axis::z}) {
      field.set_provenance({"tiles", 0, "", "", up});
      const bool turns = usual.right == name_of(up);
      const Plane plane = upright(plane_of(field, options), up);
      EXPECT_EQ(plane.up, turns ? usual.right : usual.up);
      EXPECT_EQ(plane.step_up, turns ? usual.step_right : usual.step_up);
      EXPECT_EQ(plane.first_right, turns ? usual.first_up : usual.first_right);
      EXPECT_EQ(plane.normal, usual.normal);
      const SlicePicture picture = draw_slice(field, options);
      const auto [least, greatest] = std::ranges::minmax(usual.values);
      for (std::int64_t u = 0; u < plane.height; ++u)
        for (std::int64_t r = 0; r < plane.width; ++r) {
          const float value = turns ? usual.value(u, r) : usual.value(r, u);
          EXPECT_EQ(sample(picture, plane, r, u),
                    color_of(options.colormap,
                             (static_cast<double>(value) - least) / (static_cast<double>(greatest) - least)))
              << name_of(axis) << name_of(up) << ' ' << r << ',' << u;
        }
    }
  }
}

TEST(Slice, EndsOfTheColormapsAreEndsOfTheValues) {
  SliceOptions options;
  options.axis = Axis::z;
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
  options.axis = Axis::z;
  EXPECT_EQ(plane_of(field, options).position, 1e6 + 6);
  const SlicePlane chosen = slice_plane(field, options);
  EXPECT_EQ(chosen.axis, Axis::z);
  EXPECT_EQ(chosen.index, 3);
  EXPECT_EQ(chosen.position, 1e6 + 6);
  EXPECT_EQ(index(Axis::z, 0.5), 10);
}

TEST(Slice, SidesAreEnlargedByWholeFactorsAndTrueToSpace) {
  const auto size = [](Size3 samples, Vec3 spacing, int pixels = 512) {
    SliceOptions options;
    options.axis = Axis::z;
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

TEST(Slice, WhatIsBeyondTheBandIsGreyAndDarkerInside) {
  const DistanceField field = ball_field();  // clamped at 2
  SliceOptions options;
  options.axis = Axis::z;
  options.index = 40;
  const Plane plane = plane_of(field, options);
  for (const Background background : {Background::white, Background::dark}) {
    options.background = background;
    const SlicePicture picture = draw_slice(field, options);
    const Theme theme = theme_of(background);
    EXPECT_EQ(sample(picture, plane, 20, 21), theme.inside);
    EXPECT_EQ(sample(picture, plane, 50, 3), theme.outside);
    const Color at_surface = sample(picture, plane, 36, 21);
    EXPECT_NE(at_surface, theme.inside);
    EXPECT_NE(at_surface, theme.outside);
    EXPECT_EQ(picture.image.at(2, 2), theme.paper);
  }
}

TEST(Slice, InfiniteValuesAreGreyAndNoNumbersPink) {
  // Tiles from x = 8 on are absent: infinite.
  DistanceField field({{16, 8, 1}, {}, {1, 1, 1}}, kInfinite);
  const auto tile = field.store_tile(0, 0, 0);
  for (int n = 0; n < DistanceField::kTileSamples; ++n) tile[n] = static_cast<float>(n % 8);
  tile[3 + 8 * 4] = std::numeric_limits<float>::quiet_NaN();
  SliceOptions options;
  options.axis = Axis::z;
  const Plane plane = plane_of(field, options);
  const SlicePicture picture = draw_slice(field, options);
  EXPECT_EQ(sample(picture, plane, 0, 0), (Color{68, 1, 84}));
  EXPECT_EQ(sample(picture, plane, 7, 7), (Color{253, 231, 37}));
  EXPECT_EQ(sample(picture, plane, 8, 0), kWhiteTheme.outside);
  EXPECT_EQ(sample(picture, plane, 3, 4), kWhiteTheme.nothing);
  options.interpolation = Interpolation::linear;
  EXPECT_EQ(sample(draw_slice(field, options), plane, 3, 4), kWhiteTheme.nothing);
  const SlicePicture nothing = draw_slice(DistanceField({{16, 8, 1}, {}, {1, 1, 1}}, kInfinite), options);
  EXPECT_EQ(sample(nothing, plane, 0, 0), kWhiteTheme.outside);
  // Without finite values there is no legend beside the plane.
  EXPECT_LT(nothing.image.width, picture.image.width);
}

TEST(Slice, ConstantPlanesHaveOneColor) {
  DistanceField field({{4, 4, 1}, {}, {1, 1, 1}}, 3);
  EXPECT_EQ(sample(draw_slice(field, {}), plane_of(field, {}), 2, 2), kWhiteTheme.outside) << "clamped";
  std::ranges::fill(field.store_tile(0, 0, 0), 1.0f);
  EXPECT_EQ(sample(draw_slice(field, {}), plane_of(field, {}), 2, 2), (Color{68, 1, 84}));
}

// 2 at the left and 6 at the right of 8 samples.
DistanceField ramp() {
  std::vector<float> values;
  for (int n = 0; n < 8 * 8; ++n) values.push_back(2 + static_cast<float>(n % 8) * (4.0f / 7));
  return DistanceField::from_dense({{8, 8, 1}, {}, {1, 1, 1}}, kInfinite, values);
}

TEST(Slice, ValuesAreSquaresOrLinearBetweenSamples) {
  SliceOptions options;
  options.axis = Axis::z;
  options.contours = false;
  const auto colors = [&](Interpolation interpolation, int pixels) {
    options.interpolation = interpolation;
    options.pixels = pixels;
    const SlicePicture picture = draw_slice(ramp(), options);
    std::set<Color> found;
    for (int x = 0; x < picture.width; ++x) found.insert(picture.image.at(picture.left + x, picture.top + 5));
    return found.size();
  };
  EXPECT_EQ(colors(Interpolation::nearest, 88), 8u);
  EXPECT_GT(colors(Interpolation::linear, 88), 60u);
  EXPECT_GT(colors(Interpolation::automatic, 88), 60u) << "11 pixels for a sample";
  EXPECT_EQ(colors(Interpolation::automatic, 96), 8u) << "12 pixels for a sample";
}

TEST(Slice, ContoursAreWhereTheLegendHasNumbers) {
  SliceOptions options;
  options.axis = Axis::z;
  options.interpolation = Interpolation::linear;
  const SlicePicture with = draw_slice(ramp(), options);
  options.contours = false;
  const SlicePicture without = draw_slice(ramp(), options);
  // Samples are 64 pixels, so values rise by 4 over 448 pixels, from the middle of the first square on.
  std::set<int> lines;
  for (int x = 0; x < with.width; ++x)
    if (with.image.at(with.left + x, with.top + 100) != without.image.at(without.left + x, without.top + 100))
      lines.insert(x);
  std::set<int> expected;
  for (const double level : {2.5, 3.0, 3.5, 4.0, 4.5, 5.0, 5.5}) {
    const double at = 32 + (level - 2) * 112;
    expected.insert(static_cast<int>(at) - 1);
    expected.insert(static_cast<int>(at));
  }
  EXPECT_EQ(lines, expected);
}

TEST(Slice, NothingBesidesTheBarePlane) {
  SliceOptions options;
  options.axis = Axis::z;
  const SlicePicture whole = draw_slice(ramp(), options);
  options.bare = true;
  const SlicePicture bare = draw_slice(ramp(), options);
  EXPECT_EQ(std::pair(bare.image.width, bare.image.height), std::pair(512, 512));
  for (int y = 0; y < 512; y += 7)
    for (int x = 0; x < 512; ++x)
      ASSERT_EQ(bare.image.at(x, y), whole.image.at(whole.left + x, whole.top + y)) << x << ", " << y;
}

// How many pixels of a part of a picture are not paper.
int ink_in(const Image& image, int left, int top, int right, int bottom) {
  int count = 0;
  for (int y = std::max(0, top); y < std::min(bottom, image.height); ++y)
    for (int x = std::max(0, left); x < std::min(right, image.width); ++x) count += image.at(x, y) != kWhiteTheme.paper;
  return count;
}

TEST(Slice, WordsStandAroundThePlaneAndInsideThePicture) {
  SliceOptions options;
  options.title = "Ramp";
  for (const auto& field : {odd_field(), ramp(), ball_field()}) {
    const SlicePicture picture = draw_slice(field, options);
    const Image& image = picture.image;
    const int right = picture.left + picture.width, bottom = picture.top + picture.height;
    EXPECT_GT(ink_in(image, 0, 0, image.width, picture.top - 30), 100) << "title";
    EXPECT_GT(ink_in(image, 0, picture.top, picture.left, bottom), 20) << "numbers upwards";
    EXPECT_GT(ink_in(image, picture.left, bottom, right, image.height), 20) << "numbers to the right";
    EXPECT_GT(ink_in(image, right + 40, picture.top, image.width, bottom), 50) << "numbers of the legend";
    EXPECT_EQ(ink_in(image, 0, 0, 8, image.height), 0);
    EXPECT_EQ(ink_in(image, image.width - 8, 0, image.width, image.height), 0);
    EXPECT_EQ(ink_in(image, 0, 0, image.width, 8), 0);
    EXPECT_EQ(ink_in(image, 0, image.height - 8, image.width, image.height), 0);
  }
}

TEST(Slice, UnitsAndTitlesAreWritten) {
  const auto picture = [](auto change) {
    SliceOptions options;
    options.axis = Axis::z;
    change(options);
    return draw_slice(ramp(), options).image;
  };
  const Image plain = picture([](auto&) {});
  EXPECT_GT(picture([](auto& o) { o.title = "Ramp"; }).height, plain.height);
  EXPECT_NE(picture([](auto& o) { o.unit = "mm"; }).pixels, plain.pixels);
  EXPECT_GT(picture([](auto& o) { o.legend = "distance from the wall"; }).width, plain.width);
  // Whatever the bytes are, and as many as are allowed.
  EXPECT_GT(picture([](auto& o) { o.title = std::string(200, 'm'); }).width, plain.width);
  for (const std::string words : {"\xff\xfe\x80", "\n\t", "\xF0\x9F\x90"})
    EXPECT_NE(picture([&](auto& o) { o.title = words; }).pixels, plain.pixels);
}

TEST(Slice, OddExtentsAreDrawn) {
  for (const double spacing : {1e-30, 1e-7, 1.0, 1e9, 1e30})
    for (const double origin : {0.0, -3.25, 1e6, -1e30})
      for (const Size3 size : {Size3{8, 8, 1}, Size3{1, 8, 1}, Size3{1, 1, 1}, Size3{40, 2, 3}}) {
        DistanceField field({size, {origin, origin, origin}, {spacing, spacing, spacing}}, kInfinite);
        const auto tile = field.store_tile(0, 0, 0);
        for (int n = 0; n < DistanceField::kTileSamples; ++n) tile[n] = static_cast<float>(spacing * (n % 64 - 20));
        const SlicePicture picture = draw_slice(field, {});
        EXPECT_LT(picture.image.width, 512 + 500) << spacing << " " << origin;
        EXPECT_LT(picture.image.height, 512 + 400) << spacing << " " << origin;
      }
}

TEST(AxisScale, NumbersAreWhereTheirSamplesAre) {
  const AxisScale scale("x", -1, 0.25, 9, 90, 1);  // samples from -1 to 1, ten pixels each
  EXPECT_EQ(scale.place_of(-1), 5);
  EXPECT_EQ(scale.place_of(1), 85);
  std::vector<std::string> labels;
  for (const Tick& tick : scale.ticks()) labels.push_back(tick.label);
  EXPECT_EQ(labels, (std::vector<std::string>{"−1", "0", "1"})) << "as many as have room";
  EXPECT_TRUE(AxisScale("x", 0, 1, 1, 1, 1).ticks().empty()) << "no room at all";
  EXPECT_GE(AxisScale("x", 1e6, 0.001, 100, 500, 1).ticks().size(), 2u);
}

TEST(Slice, OptionsOutOfRangeAreRefused) {
  const auto refused = [](auto change, const std::string& words) {
    SliceOptions options;
    options.axis = Axis::z;
    change(options);
    expect_error([&] { draw_slice(odd_field(), options); }, ErrorCode::usage, words);
  };
  refused([](auto& o) { o.at = -0.1; }, "the place must be 0 (the first sample) to 1 (the last)");
  refused([](auto& o) { o.at = 1.1; }, "the place must be 0");
  refused([](auto& o) { o.at = std::numeric_limits<double>::quiet_NaN(); }, "the place must be 0");
  refused([](auto& o) { o.index = -1; }, "sample -1 is outside the field, which has 21 along that axis");
  refused([](auto& o) { o.index = 21; }, "sample 21 is outside the field, which has 21 along that axis");
  refused([](auto& o) { o.axis.reset(), o.index = 21; },
          "sample 21 is outside the field, which has 21 along that axis");
  refused([](auto& o) { o.axis = static_cast<Axis>(7); }, "there is no such axis");
  refused([](auto& o) { o.pixels = 0; }, "the picture's size must be 1 to 8192 pixels");
  refused([](auto& o) { o.pixels = 8193; }, "the picture's size must be 1 to 8192 pixels");
  refused([](auto& o) { o.title = std::string(201, 'm'); }, "the title has 201 characters; give it at most 200");
  refused([](auto& o) { o.unit = std::string(1'000'000, 'm'); }, "the unit has 1000000 characters");
  refused([](auto& o) { o.legend = std::string(201, 'm'); }, "the legend has 201 characters");
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
  SliceOptions options;
  options.axis = Axis::z;
  write_slice_png(folder / "a.png", odd_field(), options);
  const SlicePicture picture = draw_slice(odd_field(), options);
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
