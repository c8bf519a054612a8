// SPDX-License-Identifier: Apache-2.0
// The time left that a progress bar tells: right where work is even, silent where it is not, and never climbing.
#include "cli/time_left.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <vector>

namespace standoff::cli {
namespace {

struct Told {
  double seconds;
  std::optional<double> left;
};

// What is told every tenth of a second of work that takes so long, of which the share is done at each time.
std::vector<Told> told_of(double seconds, const std::function<double(double)>& done) {
  TimeLeft left;
  std::vector<Told> told;
  for (int tick = 1; 0.1 * tick < seconds; ++tick) told.push_back({0.1 * tick, left.at(0.1 * tick, done(0.1 * tick))});
  return told;
}

void expect_no_climb(const std::vector<Told>& told) {
  double least = INFINITY;
  for (const auto& [seconds, left] : told)
    if (left) {
      EXPECT_LE(*left, least) << "after " << seconds << " s";
      least = *left;
    }
}

TEST(TimeLeft, IsRightWhereWorkIsEven) {
  const auto told = told_of(20, [](double t) { return t / 20; });
  expect_no_climb(told);
  for (const auto& [seconds, left] : told) {
    if (seconds < 1.05) continue;
    ASSERT_TRUE(left) << seconds;
    EXPECT_NEAR(*left, 20 - seconds, 1e-6);
  }
}

// Steps that wobble by a few hundredths, as those of threads do.
TEST(TimeLeft, IsAboutRightWhereWorkWobbles) {
  const auto told = told_of(20, [](double t) { return t / 20 + 0.02 * std::sin(3 * t) * t / 20; });
  expect_no_climb(told);
  std::size_t silent = 0;
  for (const auto& [seconds, left] : told) {
    if (seconds < 1.05) continue;
    silent += !left;
    if (!left) continue;
    EXPECT_NEAR(*left, 20 - seconds, 0.2 * (20 - seconds) + 0.3) << seconds;
  }
  EXPECT_LT(silent, told.size() / 20);
}

// A fifth of the bar passes in a moment, as where a mesh is prepared, and says nothing of the rest.
TEST(TimeLeft, IsSilentAfterALeap) {
  const auto told = told_of(10, [](double t) { return t < 0.2 ? t : 0.2 + 0.8 * (t - 0.2) / 9.8; });
  expect_no_climb(told);
  for (const auto& [seconds, left] : told)
    EXPECT_NEAR(left.value_or(10 - seconds), 10 - seconds, 0.1 * (10 - seconds) + 0.1) << seconds;
  EXPECT_FALSE(told[9].left) << "after a second: a fifth a second before, and a twelfth now";
  EXPECT_TRUE(told[80].left);
}

// Work that becomes four times slower in its middle: what was told is not taken back by a larger number.
TEST(TimeLeft, NeverClimbs) {
  const auto told = told_of(25, [](double t) { return t < 5 ? t / 10 : 0.5 + (t - 5) / 40; });
  expect_no_climb(told);
  EXPECT_NEAR(*told[39].left, 6, 1e-6);
  const auto silent = std::ranges::count_if(told, [](const Told& one) { return !one.left; });
  EXPECT_GT(silent, 50);
}

TEST(TimeLeft, SaysNothingOfABeginningOrAStandstill) {
  TimeLeft left;
  for (int tick = 1; tick < 100; ++tick) EXPECT_FALSE(left.at(0.1 * tick, 0)) << tick;
  EXPECT_FALSE(TimeLeft().at(0.1, 0.9));
}

TEST(TimeLeft, Words) {
  EXPECT_EQ(time_left_text(0.3), "less than 1 s left");
  EXPECT_EQ(time_left_text(7.6), "8 s left");
  EXPECT_EQ(time_left_text(200), "3 min left");
  EXPECT_EQ(time_left_text(7200), "2 h left");
}

}  // namespace
}  // namespace standoff::cli
