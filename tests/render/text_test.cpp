// SPDX-License-Identifier: Apache-2.0
#include "render/text.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>
#include <string>

namespace standoff {
namespace {

constexpr Color kPaper{255, 255, 255}, kInk{0, 0, 0};

// How dark a text makes a picture, in black pixels.
double ink(const Image& image) {
  double sum = 0;
  for (const Color& pixel : image.pixels) sum += (255 - pixel[0]) / 255.0;
  return sum;
}

Image drawn(std::string_view text, double size, double x = 10) {
  Image image(400, 60, kPaper);
  draw_text(image, x, 45, text, size, kInk);
  return image;
}

// The box of a fresh letter: first and last columns and rows with ink.
struct Bounds {
  int left = 1000, top = 1000, right = -1, bottom = -1;
};
Bounds bounds_of(const Image& image) {
  Bounds b;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      if (image.at(x, y)[0] < 128)
        b = {std::min(b.left, x), std::min(b.top, y), std::max(b.right, x), std::max(b.bottom, y)};
  return b;
}

TEST(Coverage, IsTheAreaInside) {
  // A square of 2.5 by 1.5 at (1.25, 0.75), and a turned one.
  Coverage square(5, 3);
  const auto add = [](Coverage& coverage, std::vector<std::pair<double, double>> corners) {
    for (std::size_t n = 0; n < corners.size(); ++n) {
      const auto [x0, y0] = corners[n];
      const auto [x1, y1] = corners[(n + 1) % corners.size()];
      coverage.add_line(x0, y0, x1, y1);
    }
  };
  add(square, {{1.25, 0.75}, {3.75, 0.75}, {3.75, 2.25}, {1.25, 2.25}});
  const std::vector<float> expected{0,    0.75 * 0.25, 0.25, 0.75 * 0.25, 0,    0,           0.75, 1,
                                    0.75, 0,           0,    0.75 * 0.25, 0.25, 0.75 * 0.25, 0};
  const std::vector<float> shares = square.shares();
  for (std::size_t n = 0; n < expected.size(); ++n) EXPECT_NEAR(shares[n], expected[n], 1e-6) << n;

  Coverage turned(10, 10);
  add(turned, {{5, 1}, {1, 5}, {5, 9}, {9, 5}});
  double sum = 0;
  for (const float share : turned.shares()) sum += share;
  EXPECT_NEAR(sum, 32, 1e-5);
  EXPECT_NEAR(turned.shares()[13], 0.0, 1e-6);
  EXPECT_NEAR(turned.shares()[14], 0.5, 1e-6) << "either way around";

  // What lies outside the window does not change what is inside.
  Coverage cut(3, 3);
  add(cut, {{-100, -1e9}, {-7, 2.5}, {1e9, 2.5}, {50, -1e9}});
  for (int n = 0; n < 9; ++n) EXPECT_NEAR(cut.shares()[n], n < 6 ? 1 : 0.5, 1e-6) << n;
}

TEST(Text, LettersStandOnTheLineAndHaveTheirHeight) {
  for (const double size : {20.0, 33.3, 44.0}) {
    const Bounds h = bounds_of(drawn("H", size));
    EXPECT_EQ(h.bottom, 44) << "on the baseline";
    EXPECT_NEAR(h.bottom + 1 - h.top, cap_height(size), 1);
    EXPECT_GT(bounds_of(drawn("g", size)).bottom, 46) << "has a tail";
  }
  // L is a stem and a foot: ink on the left and below, none at the upper right.
  const Image l = drawn("L", 40);
  const Bounds b = bounds_of(l);
  EXPECT_LT(l.at(b.left + 1, b.top + 2)[0], 20);
  EXPECT_LT(l.at(b.right - 1, b.bottom - 1)[0], 20);
  EXPECT_EQ(l.at(b.right - 1, b.top + 2), kPaper);
}

TEST(Text, HolesStayOpen) {
  for (const std::string letter : {"O", "0", "o", "D"}) {
    const Image image = drawn(letter, 44);
    const Bounds b = bounds_of(image);
    EXPECT_EQ(image.at((b.left + b.right) / 2, (b.top + b.bottom) / 2), kPaper) << letter;
  }
}

TEST(Text, EdgesAreSmoothAndInkDoesNotDependOnThePlace) {
  EXPECT_NEAR(ink(drawn("Rate 3", 15, 10)), ink(drawn("Rate 3", 15, 10.37)), 0.5);
  std::set<int> greys;
  for (const Color& pixel : drawn("S", 30).pixels) greys.insert(pixel[0]);
  EXPECT_GT(greys.size(), 20u);
  EXPECT_NEAR(ink(drawn("B", 40)) / ink(drawn("B", 20)), 4, 0.05) << "all sizes have one shape";
}

TEST(Text, WidthsAddUp) {
  EXPECT_EQ(text_width("", 15), 0);
  EXPECT_DOUBLE_EQ(text_width("nn", 15), 2 * text_width("n", 15));
  EXPECT_DOUBLE_EQ(text_width("n", 30), 2 * text_width("n", 15));
  EXPECT_GT(text_width("m", 15), text_width("i", 15));
  for (const char digit : std::string("0123456789"))
    EXPECT_EQ(text_width(std::string(1, digit), 15), text_width("0", 15)) << "digits stand below one another";
  // Neighbours that leave a gap move together.
  EXPECT_LT(text_width("AV", 15), text_width("A", 15) + text_width("V", 15) - 0.3);
  EXPECT_LT(bounds_of(drawn("AV", 40)).right, bounds_of(drawn("A V", 40)).right - 8);
}

TEST(Text, EveryCharacterOfTheFontIsDrawn) {
  const auto has = [](char32_t c) { return glyph_of(c) != 0; };
  for (char32_t c = ' '; c <= '~'; ++c) EXPECT_TRUE(has(c)) << static_cast<int>(c);
  for (const char32_t c : U"×°²³µ−≤≥±→↑ÄöüßŁőΩπЖя…–") EXPECT_EQ(has(c), c != 0) << static_cast<int>(c);
  EXPECT_FALSE(has(U'漢'));
  EXPECT_FALSE(has('\n'));
  int letters = 0;
  for (char32_t c = 0; c < 0x2600; ++c) {
    const std::uint32_t glyph = glyph_of(c);
    if (glyph == 0) continue;
    ++letters;
    // Closed outlines, all in the reach of a line.
    FontPoint sum;
    for (const FontCurve& curve : outline_of(glyph)) {
      sum = {sum.x + curve.to.x - curve.from.x, sum.y + curve.to.y - curve.from.y};
      ASSERT_LT(std::abs(curve.to.x), 2 * kFontUnits) << static_cast<int>(c);
      ASSERT_LT(std::abs(curve.to.y), 1.5 * kFontUnits) << static_cast<int>(c);
    }
    EXPECT_EQ(sum.x, 0) << static_cast<int>(c);
    EXPECT_EQ(sum.y, 0) << static_cast<int>(c);
    EXPECT_GE(advance_of(glyph), 0) << static_cast<int>(c);
  }
  EXPECT_GT(letters, 500);
}

TEST(Text, WhatIsNoUtf8IsReplaced) {
  const auto read = [](std::string_view text) { return characters_of(text); };
  EXPECT_EQ(read("a\xC3\xA9\xE2\x82\xAC\xF0\x9F\x90\x87"), U"aé€🐇");
  EXPECT_EQ(read("\xff"), U"\uFFFD");
  EXPECT_EQ(read("\x80\x80"), U"\uFFFD\uFFFD");
  EXPECT_EQ(read("\xC3"), U"\uFFFD") << "cut off";
  EXPECT_EQ(read("\xC3("), U"\uFFFD(");
  EXPECT_EQ(read("\xE2\x82"), U"\uFFFD") << "one for all that began well";
  EXPECT_EQ(read("\xF0\x9F\x90z"), U"\uFFFDz");
  EXPECT_EQ(read("\xC0\xAF"), U"\uFFFD\uFFFD") << "longer than need be";
  EXPECT_EQ(read("\xE0\x80\xAF"), U"\uFFFD\uFFFD\uFFFD");
  EXPECT_EQ(read("\xED\xA0\x80"), U"\uFFFD\uFFFD\uFFFD") << "a surrogate";
  EXPECT_EQ(read("\xF4\x90\x80\x80"), U"\uFFFD\uFFFD\uFFFD\uFFFD") << "past the last character";
  EXPECT_EQ(read(std::string_view("a\0b", 3)), std::u32string(U"a\0b", 3));
  // Boxes, one for each: all the same, and nothing else is.
  EXPECT_EQ(drawn("\xff", 30).pixels, drawn("\n", 30).pixels);
  EXPECT_EQ(drawn("\xff", 30).pixels, drawn("漢", 30).pixels);
  EXPECT_GT(ink(drawn("\xff", 30)), 50);
  EXPECT_DOUBLE_EQ(text_width("\xff\xff", 30), 2 * text_width("漢", 30));
}

TEST(Text, IsCutAtTheEdges) {
  Image image(20, 10, kPaper);
  draw_text(image, -7, 5, "WWWWWWW", 14, kInk);
  EXPECT_GT(ink(image), 20);
  const Image before = image;
  for (const double away : {-1e4, 1e4, -1e300, 1e300}) {
    draw_text(image, away, 5, "WWW", 14, kInk);
    draw_text(image, 0, away, "WWW", 14, kInk);
  }
  EXPECT_EQ(image.pixels, before.pixels);
  // A picture in the left stem of a letter that is far larger.
  double stem = kFontUnits;
  for (const FontCurve& curve : outline_of(glyph_of('H'))) stem = std::min(stem, curve.to.x);
  Image black(4, 4, kPaper);
  draw_text(black, -(stem + 100) * 9000 / kFontUnits, 1000, "H", 9000, kInk);
  EXPECT_EQ(ink(black), 16);
}

}  // namespace
}  // namespace standoff
