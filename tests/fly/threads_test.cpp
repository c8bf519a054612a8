// SPDX-License-Identifier: Apache-2.0
// Flies on many threads fly as on one.
// labels: memory threads
#include <gtest/gtest.h>

#include <atomic>

#include "tests/fly/room.h"

namespace standoff::fly {
namespace {

using namespace standoff::testing;

TEST(Fly, RepeatsWithItsSeedOnAnyNumberOfThreads) {
  FlightOptions options;
  options.speed = 0.3;
  options.threads = 1;
  const Flown one = flown(options, 500, 6);
  options.threads = 4;
  const Flown four = flown(options, 500, 6);
  options.seed = 2;
  const Flown other = flown(options, 500, 6);
  for (std::size_t n = 0; n < one.fliers.size(); ++n) {
    EXPECT_EQ(one.fliers[n].pose, four.fliers[n].pose);
    EXPECT_EQ(one.fliers[n].collisions, four.fliers[n].collisions);
    EXPECT_NE(one.fliers[n].pose, other.fliers[n].pose);
  }
}

TEST(Fly, RecomputesTheSameFieldsOnAnyNumberOfThreads) {
  FlightOptions options;
  options.mode = FlightMode::thesis;
  options.thickness = 0.5;
  options.recompute = true;
  options.speed = 0.3;
  options.threads = 1;
  const Flown one = flown(options, 40, 6);
  options.threads = 4;
  const Flown four = flown(options, 40, 6);
  std::int64_t collisions = 0;
  for (std::size_t n = 0; n < one.fliers.size(); ++n) {
    EXPECT_EQ(one.fliers[n].pose, four.fliers[n].pose);
    EXPECT_EQ(one.fliers[n].collisions, four.fliers[n].collisions);
    collisions += one.fliers[n].collisions;
  }
  EXPECT_GT(collisions, 5);
}

TEST(Fly, ProgressIsToldByOneThreadAtATimeAndStops) {
  FlightOptions options;
  options.speed = 0.3;
  options.threads = 4;
  std::atomic<int> inside{0}, told{0};
  options.progress = [&](const Progress&) {
    EXPECT_EQ(inside++, 0);
    --inside;
    return ++told < 3;
  };
  EXPECT_EQ(code_of([&] { flown(options, 1'000'000, 6); }), ErrorCode::interrupted);
  EXPECT_GE(told, 3);
}

}  // namespace
}  // namespace standoff::fly
