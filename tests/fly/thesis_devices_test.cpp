// SPDX-License-Identifier: Apache-2.0
// Flights in the mode thesis are the same wherever Algorithm 2 runs.
// labels: none
#include <gtest/gtest.h>

#include "gpu/emulation/block.h"
#include "standoff/testing/emulation.h"
#include "standoff/thesis.h"
#include "tests/fly/room.h"

namespace standoff::fly {
namespace {

using namespace standoff::testing;

FlightOptions thesis_options(double speed) {
  FlightOptions options;
  options.mode = FlightMode::thesis;
  options.thickness = 0.5;
  options.speed = speed;
  return options;
}

std::int64_t collisions_of(const Flown& all) {
  std::int64_t sum = 0;
  for (const Flier& it : all.fliers) sum += it.collisions;
  return sum;
}

TEST(Fly, TheThesisFliesAlikeOnEveryDevice) {
  for (const bool recompute : {false, true}) {
    FlightOptions options = thesis_options(recompute ? 0.4 : 0.2);
    options.recompute = recompute;
    const Flown on_cpu = flown(options, 40, 3);
    EXPECT_GT(collisions_of(on_cpu), 0);
    options.backend = testing::kEmulated;
    for (const auto order : {emulation::Order::forward, emulation::Order::reverse, emulation::Order::random}) {
      const emulation::OrderScope scope(order, 3);
      const std::int64_t launches = emulation::launch_count();
      const Flown emulated = flown(options, 40, 3);
      EXPECT_GT(emulation::launch_count(), launches + 120);
      ASSERT_EQ(emulated.path.size(), on_cpu.path.size());
      for (std::size_t n = 0; n < on_cpu.path.size(); ++n) {
        EXPECT_EQ(emulated.path[n].step, on_cpu.path[n].step) << n;
        EXPECT_EQ(emulated.path[n].point, on_cpu.path[n].point) << n;
      }
      for (std::size_t n = 0; n < on_cpu.fliers.size(); ++n)
        EXPECT_EQ(emulated.fliers[n].collisions, on_cpu.fliers[n].collisions) << n;
    }
  }
}

TEST(Fly, SaysWhereItFindsContacts) {
  const Body ball(ball_mesh(0.3, 3));
  FlightOptions options = thesis_options(0.3);
  for (const bool recompute : {false, true}) {
    options.recompute = recompute;
    options.mode = FlightMode::thesis;
    options.backend = Backend::automatic;
    World world(ball, options);
    EXPECT_EQ(world.backend(), Backend::cpu);
    EXPECT_EQ(world.device_name(), "");
    EXPECT_EQ(world.flier_grid(), minimum_grid(ball.bounds(), 0.5, 2, 0.3));
    options.backend = testing::kEmulated;
    world.set_options(options);
    EXPECT_EQ(world.backend(), testing::kEmulated);
    EXPECT_EQ(world.device_name(), "emulated on the CPU");
    options.mode = FlightMode::sweep;
    world.set_options(options);
    EXPECT_EQ(world.backend(), Backend::cpu);
    EXPECT_EQ(world.device_name(), "");
    EXPECT_EQ(world.flier_grid(), ball.grid());
  }
}

}  // namespace
}  // namespace standoff::fly
