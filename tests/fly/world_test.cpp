// SPDX-License-Identifier: Apache-2.0
// Flies in a small labyrinth: what they pass through, what repeats, what is written.
#include <gtest/gtest.h>

#include "fly/crossing_check.h"
#include "fly/world.h"
#include "io/points/points.h"
#include "standoff/compute.h"
#include "standoff/thesis.h"
#include "tests/collision/bodies.h"
#include "tests/fly/room.h"
#include "tests/support/temp_folder.h"

namespace standoff::fly {
namespace {

using namespace standoff::testing;

std::int64_t total(const Flown& all, std::int64_t Flier::*what) {
  std::int64_t sum = 0;
  for (const Flier& it : all.fliers) sum += it.*what;
  return sum;
}

// A tolerance of 0 stands for the automatic one wherever it counts: for the sweeps, for where a flier stops, and for
// how far from resting bodies it starts.
TEST(Fly, ByDefaultTheToleranceIsAutomatic) {
  FlightOptions options;
  options.speed = 0.7;
  const Flown by_default = flown(options, 300, 5);
  options.tolerance = automatic_tolerance(Body(room()), Body(ball_mesh(0.3, 3)));
  const Flown named = flown(options, 300, 5);
  ASSERT_EQ(by_default.path.size(), named.path.size());
  std::int64_t collisions = 0;
  for (std::size_t n = 0; n < named.path.size(); ++n) EXPECT_EQ(by_default.path[n].point, named.path[n].point) << n;
  for (const Flier& it : named.fliers) collisions += it.collisions;
  EXPECT_GT(collisions, 10);
}

TEST(Fly, SweptOnesPassThroughNothingAtAnySpeed) {
  for (const OnContact what : {OnContact::turn_back, OnContact::reflect})
    for (const double speed : {0.02, 0.5, 5.0, 100.0}) {
      FlightOptions options;
      options.speed = speed;
      options.on_contact = what;
      const Flown all = flown(options, 300, 8);
      EXPECT_EQ(total(all, &Flier::crossings), 0) << speed;
      EXPECT_GT(total(all, &Flier::collisions), 0) << speed;
      for (const Flier& it : all.fliers) {
        const Vec3 p = it.pose.translation;
        EXPECT_TRUE(p.x > 0 && p.x < 10 && p.y > 0 && p.y < 4 && p.z > 0 && p.z < 6) << speed;
      }
    }
}

TEST(Fly, TheThesisMissesWhatIsFast) {
  FlightOptions options;
  options.mode = FlightMode::thesis;
  options.thickness = 0.5;
  options.speed = 0.02;
  const Flown slow = flown(options, 1200, 8);
  EXPECT_EQ(total(slow, &Flier::crossings), 0);
  EXPECT_GT(total(slow, &Flier::collisions), 0);
  options.speed = 5;
  EXPECT_GT(total(flown(options, 200, 8), &Flier::crossings), 0);
}

// Each step is decided by a field of the body where it goes.
TEST(Fly, RecomputesItsFieldAtEachStep) {
  FlightOptions options;
  options.mode = FlightMode::thesis;
  options.thickness = 0.5;
  options.speed = 0.3;
  options.recompute = true;
  options.threshold = 0.2;
  const Mesh walls = room(), ball = ball_mesh(0.3, 3);
  World world(Body(ball), options);
  world.add(Body(walls));
  world.add_flier({{0.5, 0.5, 0.5}, {9.5, 3.5, 5.5}});
  const auto field_of = [&](const Mesh& mesh, Method method) {
    const Grid grid = minimum_grid(bounds(mesh), options.thickness, options.minimum, options.speed);
    return compute(mesh, grid, options.thickness,
                   {.method = method, .skip = {SkipRule::Kind::none}, .sign = {SignMethod::none}})
        .field;
  };
  const DistanceField of_walls = field_of(walls, Method::tiles);
  EXPECT_EQ(world.grid(0), of_walls.grid());
  int collisions = 0;
  for (int n = 0; n < 200; ++n) {
    const Flier before = world.fliers()[0];
    Pose next = before.pose;
    next.translation = next.translation + before.direction * options.speed;
    Mesh there = ball;
    for (Vec3& v : there.vertices) v = apply(next, v);
    const DistanceField field = field_of(there, Method::thesis);
    const bool hit = collide_thesis(of_walls, {}, field, {}, options.threshold).hit;
    collisions += hit;
    world.run(1);
    ASSERT_EQ(world.fliers()[0].collisions, collisions) << n;
    ASSERT_EQ(world.fliers()[0].pose, hit ? before.pose : next) << n;
    if (!hit) {
      EXPECT_EQ(world.flier_grid(), field.grid());
    }
  }
  EXPECT_GT(collisions, 3);
  EXPECT_LT(collisions, 150);
}

// A page asks for a pose 60 times a second, and changes what it likes in between.
TEST(Fly, RunsInPartsAndGoesOnInOtherWorlds) {
  FlightOptions options;
  options.speed = 0.3;
  const Flown whole = flown(options, 300, 4);
  const Body walls(room()), body(ball_mesh(0.3, 3));
  World parts(body, options);
  parts.add(walls);
  for (int n = 0; n < 4; ++n) parts.add_flier({{0.5, 0.5, 0.5}, {9.5, 3.5, 5.5}});
  for (int n = 0; n < 100; ++n) parts.run(1);
  World other(body, options);
  other.add(walls);
  for (const Flier& it : parts.fliers()) other.restore_flier(it);
  other.set_options(options);
  other.run(200);
  for (std::size_t n = 0; n < 4; ++n) {
    EXPECT_EQ(other.fliers()[n].pose, whole.fliers[n].pose) << n;
    EXPECT_EQ(other.fliers()[n].collisions, whole.fliers[n].collisions) << n;
  }
  other.keep_fliers(1);
  ASSERT_EQ(other.fliers().size(), 1u);
  EXPECT_EQ(other.fliers()[0].pose, whole.fliers[0].pose);
}

TEST(Fly, ChangesItsModeInFlight) {
  FlightOptions options;
  options.thickness = 0.5;
  options.speed = 5;
  World world(Body(ball_mesh(0.3, 3)), options);
  world.add(Body(room()));
  for (int n = 0; n < 8; ++n) world.add_flier({{0.5, 0.5, 0.5}, {9.5, 3.5, 5.5}});
  const auto crossings = [&] {
    std::int64_t sum = 0;
    for (const Flier& it : world.fliers()) sum += it.crossings;
    return sum;
  };
  world.run(200);
  EXPECT_EQ(crossings(), 0);
  options.mode = FlightMode::thesis;
  world.set_options(options);
  EXPECT_EQ(world.options().mode, FlightMode::thesis);
  world.run(200);
  const std::int64_t crossed = crossings();
  EXPECT_GT(crossed, 0);
  options.mode = FlightMode::sweep;
  world.set_options(options);
  world.run(200);
  EXPECT_EQ(crossings(), crossed);
}

TEST(Fly, KnowsHowNearTheWallsAre) {
  const Mesh walls = room();
  const Pose pose = make_pose({0, 1, 0}, 0.5, {1, 2, 3});
  World world(Body(ball_mesh(0.3, 3)), {});
  std::vector<double> distances(3);
  const std::vector<Vec3> points{{2, 1.5, 2}, {4.4, 2, 3}, {5, 1, 5}};
  for (const Vec3& p : points) {
    Flier it;
    it.pose.translation = apply(pose, p);
    it.direction = {1, 0, 0};
    world.restore_flier(it);
  }
  world.wall_distances(distances);
  for (const double d : distances) EXPECT_EQ(d, std::numeric_limits<double>::infinity());
  world.add(Body(walls), pose);
  world.wall_distances(distances);
  EXPECT_NEAR(distances[0], 1.5, 1e-9);  // the floor
  EXPECT_NEAR(distances[1], 0.6, 1e-9);  // the wall in the middle
  EXPECT_NEAR(distances[2], 1, 1e-9);    // the hole in it: the floor again, the wall behind, the edge of the hole
}

TEST(Fly, StaysInItsRoom) {
  FlightOptions options;
  options.speed = 0.5;
  options.bounds = {{1, 1, 1}, {4, 3, 3}};
  const Body walls(room()), body(ball_mesh(0.3, 3));
  World world(body, options);
  world.add(walls);
  world.add_flier({{1.5, 1.5, 1.5}, {2, 2, 2}});
  world.run(1000);
  EXPECT_GT(world.fliers()[0].turns, 0);
  const Vec3 p = world.fliers()[0].pose.translation;
  EXPECT_TRUE(p.x >= 1 && p.x <= 4 && p.y >= 1 && p.y <= 3 && p.z >= 1 && p.z <= 3);
}

TEST(Fly, PathsAreTablesAndPolylines) {
  const TempFolder folder;
  const std::vector<PathPoint> points{{0, 0, {1, 2, 3}}, {0, 7, {1.5, 2, 3}}, {1, 0, {0, 0, 0.1}}};
  write_path(folder.path() / "p.csv", points);
  EXPECT_EQ(read_bytes(folder.path() / "p.csv"),
            "flier,step,x,y,z\n0,0,1,2,3\n0,7,1.5,2,3\n1,0,0,0,0.10000000000000001\n");
  write_path(folder.path() / "p.ply", points);
  const std::string ply = read_bytes(folder.path() / "p.ply");
  EXPECT_NE(ply.find("element vertex 3"), std::string::npos);
  EXPECT_NE(ply.find("element edge 1\n"), std::string::npos);
  EXPECT_TRUE(ply.ends_with("0 0 0.10000000000000001\n0 1\n"));
  EXPECT_THROW(write_path(folder.path() / "p.txt", points), Error);
}

// Pictures of paths ask where each flier's begins.
TEST(Fly, PathsAreReadFlierByFlier) {
  const TempFolder folder;
  const std::vector<PathPoint> points{{0, 0, {1, 2, 3}}, {0, 1, {1, 2, 4}}, {3, 0, {5, 6, 7}},
                                      {4, 0, {8, 8, 8}}, {4, 1, {8, 8, 9}}, {4, 2, {8, 9, 9}}};
  for (const char* name : {"path.csv", "path.ply"}) {
    write_path(folder / name, points);
    const std::string text = read_bytes(folder / name);
    EXPECT_TRUE(is_path(text)) << name;
    EXPECT_EQ(path_starts(name, text, points.size()), (std::vector<std::size_t>{0, 2, 3})) << name;
  }
}

TEST(Crossing, AgreesWithEveryTriangle) {
  const Mesh mesh = random_soup(3, 300, 1, 0.3);
  const CrossingCheck check(mesh, {});
  Random random(1);
  int crossed = 0;
  for (int n = 0; n < 1000; ++n) {
    const Vec3 from = random.in_cube(1.5), to = from + random.in_cube(n % 2 ? 0.3 : 3);
    bool expected = false;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      expected = expected || triangles_intersect({from, to, to}, corners_at(mesh, t, {}));
    ASSERT_EQ(check.crosses(from, to), expected);
    crossed += expected;
  }
  EXPECT_GT(crossed, 50);
}

}  // namespace
}  // namespace standoff::fly
