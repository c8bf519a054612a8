// SPDX-License-Identifier: Apache-2.0
// A job in a process of its own: what it returns, when it is stopped, how it fails.
#include "bench/child.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <ctime>
#include <numeric>
#include <stdexcept>
#include <thread>

namespace {

using standoff::bench::run_in_child;
using Values = std::vector<double>;

double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

TEST(Child, ReturnsMoreThanAPipeHolds) {
  Values values(300'000);
  std::iota(values.begin(), values.end(), 0.5);
  EXPECT_EQ(run_in_child(60, [&] { return values; }), values);
  EXPECT_EQ(run_in_child(60, [] { return Values{}; }), Values{});
}

TEST(Child, ChangesNothingHere) {
  int changed = 0;
  EXPECT_EQ(run_in_child(60, [&] { return Values{static_cast<double>(++changed)}; }), Values{1});
  EXPECT_EQ(changed, 0);
}

TEST(Child, IsStoppedAtItsLimit) {
  const auto never = [] {
    for (volatile int n = 0;; n = n + 1) continue;
    return Values{};
  };
  EXPECT_EQ(run_in_child(0.2, never), std::nullopt);
}

TEST(Child, IsNotStoppedForWaiting) {
  const auto sleep = [] {
    std::this_thread::sleep_for(std::chrono::milliseconds(400));
    return Values{1};
  };
  EXPECT_EQ(run_in_child(0.2, sleep), Values{1});
}

// Ratios of milliseconds rest on it: in ticks, no stretch of time would be shorter than one.
TEST(Child, SeesItsTimeInMoreThanTicks) {
  const auto busy = [] {
    const double start = cpu_seconds();
    while (cpu_seconds() - start < 100e-6) continue;
    return Values{cpu_seconds() - start};
  };
  double least = 1;  // of several: the system may count its own work in
  for (int n = 0; n < 20; ++n) least = std::min(least, run_in_child(60, busy).value().at(0));
  EXPECT_LT(least, 900e-6);
}

TEST(Child, TellsOfFailures) {
  EXPECT_THROW(run_in_child(60, []() -> Values { throw std::runtime_error("on purpose"); }), std::runtime_error);
  EXPECT_THROW(run_in_child(60, []() -> Values { std::_Exit(3); }), std::runtime_error);
  EXPECT_THROW(run_in_child(60,
                            []() -> Values {
                              std::raise(SIGKILL);
                              return {};
                            }),
               std::runtime_error);
}

}  // namespace
