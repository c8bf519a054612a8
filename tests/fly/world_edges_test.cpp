// SPDX-License-Identifier: Apache-2.0
// What a world refuses, and flights whose course is known.
#include <gtest/gtest.h>
#include <optional>

#include <cmath>
#include <limits>

#include "standoff/cuda.h"
#include "tests/api/misuse.h"
#include "tests/fly/room.h"
#include "tests/support/temp_folder.h"

namespace standoff::fly {
namespace {

using namespace standoff::testing;

const Body& ball() {
  static const Body model(ball_mesh(0.3, 3));
  return model;
}

std::optional<ErrorCode> code_with(auto FlightOptions::*what, auto value) {
  FlightOptions options;
  options.*what = value;
  return code_of([&] { World world(ball(), options); });
}

TEST(World, RefusesWhatMakesNoSense) {
  const double nan = std::nan(""), infinity = std::numeric_limits<double>::infinity();
  for (const double bad : {-1.0, nan, infinity}) {
    EXPECT_EQ(code_with(&FlightOptions::speed, bad), ErrorCode::usage) << bad;
    EXPECT_EQ(code_with(&FlightOptions::tolerance, bad), ErrorCode::usage) << bad;
    EXPECT_EQ(code_with(&FlightOptions::thickness, bad), ErrorCode::usage) << bad;
    EXPECT_EQ(code_with(&FlightOptions::threshold, bad), ErrorCode::usage) << bad;
    EXPECT_EQ(code_with(&FlightOptions::scatter_rad, bad), ErrorCode::usage) << bad;
  }
  EXPECT_EQ(code_with(&FlightOptions::tolerance, -1.0), ErrorCode::usage);
  EXPECT_EQ(code_with(&FlightOptions::threads, -1), ErrorCode::usage);
  FlightOptions thesis;
  thesis.mode = FlightMode::thesis;
  thesis.device = -1;
  EXPECT_EQ(code_of([&] { World world(ball(), thesis); }), ErrorCode::usage);
  thesis.device = 0;
  thesis.backend = Backend::cuda;
  for (thesis.recompute = false;; thesis.recompute = true) {
    if (cuda::devices().empty()) {
      EXPECT_EQ(code_of([&] { World world(ball(), thesis); }), ErrorCode::device);
    }
    if (thesis.recompute) break;
  }
  World world(ball(), {});
  Pose bad;
  bad.rotation[0] = nan;
  EXPECT_EQ(code_of([&] { world.add(ball(), bad); }), ErrorCode::usage);
  bad.rotation[0] = 2;
  EXPECT_EQ(code_of([&] { world.add(ball(), bad); }), ErrorCode::usage);
  EXPECT_EQ(code_of([&] { world.add_flier({}); }), ErrorCode::usage);
  EXPECT_EQ(code_of([&] { world.add_flier({{0, 0, 0}, {1, infinity, 1}}); }), ErrorCode::usage);
  EXPECT_EQ(code_of([&] { world.grid(0); }), ErrorCode::usage) << "nothing stands there";
  world.add(ball());
  EXPECT_EQ(world.grid(0), ball().grid());
  EXPECT_EQ(code_of([&] { world.grid(1); }), ErrorCode::usage);
  EXPECT_EQ(code_of([&] {
              world.add_flier({{-0.01, -0.01, 0.29}, {0.01, 0.01, 0.31}});
            }),
            ErrorCode::input)
      << "no free pose";
}

TEST(World, FliesStraightWhereNothingIs) {
  FlightOptions options;
  options.speed = 0.5;
  World world(ball(), options);
  world.add_flier({{-1, -1, -1}, {1, 1, 1}});
  const Flier start = world.fliers()[0];
  world.run(100);
  world.run(0);
  const Flier end = world.fliers()[0];
  EXPECT_NEAR(length(start.direction), 1, 1e-12);
  EXPECT_NEAR(length(end.pose.translation - (start.pose.translation + start.direction * 50)), 0, 1e-12);
  EXPECT_EQ(end.direction, start.direction);
  EXPECT_EQ(end.pose.rotation, start.pose.rotation);
  EXPECT_EQ(end.collisions + end.turns + end.crossings, 0);
}

TEST(World, NoSpeedIsNoMotion) {
  FlightOptions options;
  options.speed = 0;
  const Flown all = flown(options, 50, 3);
  for (const Flier& it : all.fliers) EXPECT_EQ(it.collisions + it.crossings, 0);
  for (const PathPoint& point : all.path) EXPECT_EQ(point.point, all.path[point.flier * 2].point);
}

// A ball on its way down to a wide floor.
Flier after_the_floor(FlightOptions options, Flier& before) {
  options.scatter_rad = 0;
  const Body floor(one_triangle({-1e4, 0, -1e4}, {3e4, 0, -1e4}, {-1e4, 0, 3e4}));
  for (options.seed = 1;; ++options.seed) {
    World world(ball(), options);
    world.add(floor);
    world.add_flier({{-1, 4, -1}, {1, 6, 1}});
    before = world.fliers()[0];
    if (before.direction.y > -0.3) continue;
    while (world.fliers()[0].collisions == 0) world.run(1);
    return world.fliers()[0];
  }
}

TEST(World, TurnsBackOrReflects) {
  for (const double speed : {0.02, 0.7, 1000.0}) {
    SCOPED_TRACE(speed);
    FlightOptions options;
    options.speed = speed;
    options.tolerance = 1e-4;
    Flier before;
    const Flier back = after_the_floor(options, before);
    EXPECT_NEAR(length(back.direction + before.direction), 0, 1e-12);
    options.on_contact = OnContact::reflect;
    const Flier up = after_the_floor(options, before);
    const Vec3 mirrored{before.direction.x, -before.direction.y, before.direction.z};
    EXPECT_NEAR(length(up.direction - mirrored), 0, 1e-6);
    // It stopped where its lowest corner is just above the floor.
    double lowest = 1e9;
    const MeshView mesh = ball().mesh();
    for (const Vec3& v : mesh.vertices) lowest = std::min(lowest, apply(up.pose, v).y);
    EXPECT_GT(lowest, 0);
    EXPECT_LT(lowest, 4 * options.tolerance);
  }
}

TEST(World, ManyFliesAtOnceCrossNothing) {
  FlightOptions options;
  options.speed = 2;
  const Flown all = flown(options, 4, 3000);
  std::int64_t collisions = 0, crossings = 0;
  for (const Flier& it : all.fliers) collisions += it.collisions, crossings += it.crossings;
  EXPECT_GT(collisions, 1000);
  EXPECT_EQ(crossings, 0);
}

const Body& triangle() {
  static const Body model(one_triangle(), {.execution = {.threads = 1}});
  return model;
}

TEST(World, AnswersOddOptionsOrSaysWhatToDo) {
  const auto expect = [](const std::string& name, const FlightOptions& options) {
    expect_answer_or_error(name, [&] {
      World world(triangle(), options);
      world.add(triangle(), make_pose({0, 0, 1}, 0, {5, 5, 5}));
      world.add_flier({{-3, -3, -3}, {3, 3, 3}});
      world.run(3);
    });
  };
  for (const FlightMode mode : {FlightMode::sweep, FlightMode::thesis, none_of<FlightMode>()})
    for (const double x : kNumbers) {
      const auto with = [&](double FlightOptions::*member) {
        FlightOptions options;
        options.mode = mode;
        options.threads = 1;
        options.on_contact = none_of<OnContact>();
        options.*member = x;
        return options;
      };
      expect(named("speed", x), with(&FlightOptions::speed));
      expect(named("scatter", x), with(&FlightOptions::scatter_rad));
      expect(named("tolerance", x), with(&FlightOptions::tolerance));
      expect(named("thickness", x), with(&FlightOptions::thickness));
      expect(named("minimum", x), with(&FlightOptions::minimum));
      expect(named("threshold", x), with(&FlightOptions::threshold));
      FlightOptions outside = with(&FlightOptions::threshold);
      outside.threshold = 0;
      outside.bounds = {{x, -1, -1}, {1, x, 1}};
      expect(named("bounds", x), outside);
    }
  for (const int n : kThreads) {
    FlightOptions options;
    options.threads = n;
    expect_usage(named("threads", n), [&] { World(triangle(), options); });
  }
}

TEST(World, AnswersOddCallsOrSaysWhatToDo) {
  FlightOptions options;
  options.threads = 1;
  World world(triangle(), options);
  expect_usage("no body", [&] { world.grid(0); });
  expect_usage("no body", [&] { world.grid(std::numeric_limits<std::size_t>::max()); });
  expect_usage("steps", [&] { world.run(-1); });
  expect_answer_or_error("no fliers", [&] { world.run(kMost); });
  for (const Pose& pose : odd_poses()) expect_answer_or_error("add", [&] { world.add(triangle(), pose); });
  for (const double x : kNumbers) expect_answer_or_error("box", [&] { world.add_flier({{0, 0, 0}, {x, x, x}}); });
  for (const Pose& pose : odd_poses())
    for (const double x : kNumbers)
      expect_answer_or_error("flier", [&] { world.restore_flier(Flier{pose, {x, 0, 0}}); });
  FlightOptions odd = options;
  odd.speed = -1;
  expect_usage("options", [&] { world.set_options(odd); });
  EXPECT_EQ(world.options().speed, options.speed);
  world.keep_fliers(std::numeric_limits<std::size_t>::max());
  world.keep_fliers(0);
  EXPECT_TRUE(world.fliers().empty());
  std::vector<double> distances(1);
  expect_usage("distances", [&] { world.wall_distances(distances); });
  EXPECT_THROW(
      {
        World another(triangle(), options);
        another.add_flier({{0, 0, 0}, {1, 1, 1}});
        another.run(2, [](std::size_t, std::int64_t, const Pose&) { throw 5; });
      },
      int);
}

TEST(World, WritesOddPathsOrSaysWhatToDo) {
  const TempFolder folder;
  const std::vector<PathPoint> points{{-1, kMost, {kNaN, kInfinite, 0}}, {-1, 0, {}}};
  for (const auto& path :
       {std::filesystem::path(), std::filesystem::path("/"), folder / "a", folder / "no/a.csv", folder / "a.csv"}) {
    expect_answer_or_error("write_path", [&] { write_path(path, points); });
    expect_answer_or_error("write_path", [&] { write_path(path, {}, none_of<Existing>()); });
  }
}

}  // namespace
}  // namespace standoff::fly
