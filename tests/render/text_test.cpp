// SPDX-License-Identifier: Apache-2.0
#include "render/text.h"

#include <gtest/gtest.h>

#include <set>
#include <string>

namespace standoff {
namespace {

constexpr Color kPaper{255, 255, 255}, kInk{0, 0, 0};

// The dots of a text, a line of '#' and '.' per row.
std::string drawn(const std::string& text) {
  Image image(text_width(text), kTextHeight, kPaper);
  draw_text(image, 0, 0, text, kInk);
  std::string dots;
  for (int y = 0; y < image.height; y += kTextDot) {
    for (int x = 0; x < image.width; x += kTextDot) dots += image.at(x, y) == kInk ? '#' : '.';
    dots += '\n';
  }
  return dots;
}

TEST(Text, LettersHaveTheirShapes) {
  EXPECT_EQ(drawn("L4"),
            "#........#.\n"
            "#.......##.\n"
            "#......#.#.\n"
            "#.....#..#.\n"
            "#.....#####\n"
            "#........#.\n"
            "#####....#.\n");
}

TEST(Text, EveryLetterIsItsOwn) {
  std::set<std::string> shapes;
  for (char c = ' '; c <= '~'; ++c) {
    // p and q, and g and y, have tails, which these rows do not show.
    shapes.insert(drawn(std::string(1, c)));
  }
  EXPECT_EQ(shapes.size(), 95u);
  EXPECT_EQ(drawn("\n"), drawn("?"));
  EXPECT_EQ(drawn("\xff"), drawn("?"));
}

TEST(Text, WidthIsWhatIsDrawn) {
  EXPECT_EQ(text_width(""), 0);
  EXPECT_EQ(text_width("a"), 5 * kTextDot);
  EXPECT_EQ(text_width("abc"), 17 * kTextDot);
}

TEST(Text, IsCutAtTheEdges) {
  Image image(20, 10, kPaper);
  draw_text(image, -7, -3, "WWWWWWW", kInk);
  draw_text(image, 15, 8, "WWWWWWW", kInk);
  EXPECT_EQ(image.at(19, 9), kInk);
}

}  // namespace
}  // namespace standoff
