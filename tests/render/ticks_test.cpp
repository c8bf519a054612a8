// SPDX-License-Identifier: Apache-2.0
#include "render/scales.h"

#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "tests/support/comma_locale.h"

namespace standoff {
namespace {

std::string labels(double least, double greatest, int most) {
  std::string text;
  for (const Tick& tick : even_ticks(least, greatest, most)) text += (text.empty() ? "" : " ") + tick.label;
  return text;
}

TEST(Ticks, AreRoundNumbers) {
  EXPECT_EQ(labels(0, 1, 5), "0 0.2 0.4 0.6 0.8 1.0");
  EXPECT_EQ(labels(0, 1, 4), "0 0.5 1.0");
  EXPECT_EQ(labels(0, 1, 1), "0 1");
  EXPECT_EQ(labels(-0.05, 0.05, 5), "−0.04 −0.02 0 0.02 0.04");
  EXPECT_EQ(labels(0.3, 0.6, 6), "0.30 0.35 0.40 0.45 0.50 0.55 0.60") << "ends that are multiples count";
  EXPECT_EQ(labels(-3, 17, 4), "0 5 10 15");
  EXPECT_EQ(labels(0, 12345, 3), "0 5000 10000");
  EXPECT_EQ(labels(999.5, 1000.5, 2), "999.5 1000.0 1000.5");
}

TEST(Ticks, LargeAndSmallOnesShareAPowerOfTen) {
  EXPECT_EQ(labels(0, 3e6, 3), "0 1×10⁶ 2×10⁶ 3×10⁶");
  EXPECT_EQ(labels(-2.5e-7, 2.5e-7, 3), "−2×10⁻⁷ 0 2×10⁻⁷");
  EXPECT_EQ(labels(0, 1.5e-12, 3), "0 0.5×10⁻¹² 1.0×10⁻¹² 1.5×10⁻¹²");
  EXPECT_EQ(labels(0, 2e300, 2), "0 1×10³⁰⁰ 2×10³⁰⁰");
}

TEST(Ticks, CopeWithAnyRange) {
  constexpr double kLargest = std::numeric_limits<double>::max(), kInf = std::numeric_limits<double>::infinity();
  const std::vector<std::pair<double, double>> ranges{
      {-kLargest, kLargest}, {0, kLargest},        {0, 5e-324},      {0, 1e-299},
      {1e6, 1e6 + 0.1},      {-1e-20, 1e20},       {1e15, 1e15 + 1}, {1e30, 1e30 + 1e15},
      {1e30, 2e30},          {16777215, 16777216}, {-3, -2},         {0.1, 0.1000001}};
  for (const auto& [least, greatest] : ranges)
    for (int most = 1; most < 9; ++most) {
      const std::vector<Tick> ticks = even_ticks(least, greatest, most);
      EXPECT_LE(ticks.size(), static_cast<std::size_t>(most) + 1) << least << " " << greatest;
      double before = -kInf;
      const double slack = (greatest / 2 - least / 2) * 1e-6;
      for (const Tick& tick : ticks) {
        EXPECT_GT(tick.value, before);
        EXPECT_GE(tick.value, least - slack);
        EXPECT_LE(tick.value, greatest + slack);
        EXPECT_LT(tick.label.size(), 30u) << tick.label;
        before = tick.value;
      }
    }
  EXPECT_EQ(labels(1, 1, 5), "");
  EXPECT_EQ(labels(2, 1, 5), "");
  EXPECT_EQ(labels(0, kInf, 5), "");
  EXPECT_EQ(labels(std::numeric_limits<double>::quiet_NaN(), 1, 5), "");
  EXPECT_EQ(labels(0, 1, 0), "");
}

// Labels are read back as the values they stand for.
TEST(Ticks, LabelsAreTheValues) {
  for (const auto& [least, greatest] : std::vector<std::pair<double, double>>{{-7.3, 11}, {0.0123, 0.0148}, {3e4, 9e5}})
    for (const Tick& tick : even_ticks(least, greatest, 8)) {
      std::string text = tick.label;
      if (text.starts_with("−")) text = "-" + text.substr(std::string("−").size());
      EXPECT_EQ(std::stod(text), tick.value) << tick.label;
    }
}

TEST(ShortText, IsShort) {
  EXPECT_EQ(short_text(-0.0, 4), "0");
  EXPECT_EQ(short_text(0.30000000000000004, 4), "0.3");
  EXPECT_EQ(short_text(-12.5, 4), "−12.5");
  EXPECT_EQ(short_text(1234567, 4), "1.235×10⁶");
  EXPECT_EQ(short_text(-1.5e-10, 4), "−1.5×10⁻¹⁰");
  EXPECT_EQ(short_text(std::numeric_limits<double>::infinity(), 4), "inf");
}

// "0,30" stood beside the colours where the program that draws had set such a locale.
TEST(ShortText, DoesNotFollowTheLocale) {
  const CommaLocale locale;
  if (!locale.is_set()) GTEST_SKIP() << "no localedef here";
  EXPECT_EQ(short_text(0.3, 4), "0.3");
  EXPECT_EQ(short_text(1234567, 4), "1.235×10⁶");
  EXPECT_EQ(labels(0, 1, 4), "0 0.5 1.0");
}

}  // namespace
}  // namespace standoff
