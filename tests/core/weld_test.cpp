// SPDX-License-Identifier: Apache-2.0
// The exact weld against a sorted map, over many blocks and any number of threads.
// labels: memory threads
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <limits>
#include <map>
#include <random>
#include <tuple>
#include <vector>

#include "core/weld.h"

namespace standoff {
namespace {

// Numbers by a map: what weld() promises, one position after the other.
std::vector<std::uint32_t> welded_by_map(const std::vector<Vec3>& positions) {
  std::map<std::tuple<double, double, double>, std::uint32_t> known;
  std::vector<std::uint32_t> numbers;
  for (const Vec3& p : positions)
    numbers.push_back(known.try_emplace({p.x, p.y, p.z}, static_cast<std::uint32_t>(known.size())).first->second);
  return numbers;
}

std::vector<std::uint32_t> welded(const std::vector<Vec3>& positions, std::uint32_t* distinct = nullptr) {
  std::vector<std::uint32_t> numbers(positions.size());
  const std::uint32_t count = weld([&](std::uint32_t i) { return positions[i]; }, numbers);
  if (distinct) *distinct = count;
  return numbers;
}

// Positions of a small lattice, so that most are equal to others near and far.
std::vector<Vec3> lattice_positions(std::size_t count, int side, unsigned seed) {
  std::mt19937 random(seed);
  std::vector<Vec3> positions;
  while (positions.size() < count) {
    const auto coordinate = [&] {
      return static_cast<double>(static_cast<int>(random() % unsigned(side)) - side / 2) / 3;
    };
    positions.push_back({coordinate(), coordinate(), coordinate()});
  }
  return positions;
}

TEST(Weld, AgreesWithAMap) {
  for (const auto& [count, side] : {std::pair<std::size_t, int>{0, 1},
                                    {1, 1},
                                    {2, 1},
                                    {1000, 1},
                                    {1000, 100},
                                    {16384, 9},
                                    {16385, 40},
                                    {100000, 20},
                                    {200000, 60},
                                    {70000, 1000}}) {
    const auto positions = lattice_positions(count, side, static_cast<unsigned>(count));
    std::uint32_t distinct = 0;
    const auto expected = welded_by_map(positions);
    ASSERT_EQ(welded(positions, &distinct), expected) << count << " positions, side " << side;
    EXPECT_EQ(distinct, expected.empty() ? 0 : 1 + *std::max_element(expected.begin(), expected.end()));
  }
}

TEST(Weld, GivesTheSameNumbersForAnyNumberOfThreads) {
  const auto positions = lattice_positions(300000, 50, 7);
  const auto expected = welded_by_map(positions);
  for (const std::size_t threads : {1, 2, 3, 8}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    for (int repeat = 0; repeat < 3; ++repeat) ASSERT_EQ(welded(positions), expected) << threads << " threads";
  }
}

TEST(Weld, JoinsBothZerosAndNothingThatDiffers) {
  const double next = std::nextafter(1.0, 2.0), tiny = std::numeric_limits<double>::denorm_min();
  EXPECT_EQ(welded({{0, 0, 0}, {-0.0, 0, -0.0}, {0, tiny, 0}, {1, 1, 1}, {1, 1, next}, {next, 1, 1}, {1, 1, 1}}),
            (std::vector<std::uint32_t>{0, 0, 1, 2, 3, 4, 2}));
  EXPECT_EQ(welded({{1, 2, 3}, {3, 2, 1}, {2, 1, 3}, {1, 3, 2}, {-1, -2, -3}}),
            (std::vector<std::uint32_t>{0, 1, 2, 3, 4}));
}

// Scanners write a NaN for each point they missed: if NaNs differed from each other, each would take a slot of its own
// in one run of the table, and the time would grow with the square of their number.
TEST(Weld, TakesManyNotANumbersInItsStride) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<Vec3> positions(500000, Vec3{nan, 0, nan});
  std::uint32_t distinct = 0;
  welded(positions, &distinct);
  EXPECT_EQ(distinct, 1u);
}

}  // namespace
}  // namespace standoff
