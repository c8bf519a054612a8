// SPDX-License-Identifier: Apache-2.0
// collision.h, pose.h and simulation.h with arguments that make no sense.
#include "standoff/collision.h"
#include "standoff/experimental/simulation.h"
#include "standoff/testing/emulation.h"
#include "standoff/thesis.h"
#include "tests/api/misuse.h"
#include "tests/support/temp_folder.h"

namespace standoff {
namespace {

using namespace experimental;

using namespace testing;

const CollisionModel& body() {
  static const CollisionModel model(one_triangle(), {.execution = {.threads = 1}});
  return model;
}

std::vector<Pose> odd_poses() {
  std::vector<Pose> poses;
  for (const double x : kNumbers)
    for (const int entry : {0, 5, 9, 11}) {
      Pose pose;
      if (entry < 9)
        pose.rotation[static_cast<std::size_t>(entry)] = x;
      else
        (entry == 9 ? pose.translation.x : pose.translation.z) = x;
      poses.push_back(pose);
    }
  Pose mirror, zero;
  mirror.rotation[0] = -1;
  zero.rotation = {};
  poses.insert(poses.end(), {mirror, zero});
  return poses;
}

TEST(Misuse, Poses) {
  for (const double x : kNumbers) {
    expect_answer_or_error(named("axis", x), [&] { make_pose({x, 0, 0}, 1, {}); });
    expect_answer_or_error(named("angle", x), [&] { make_pose({1, 0, 0}, x, {}); });
    expect_answer_or_error(named("translation", x), [&] { make_pose({1, 0, 0}, 1, {x, x, x}); });
    expect_answer_or_error(named("time", x), [&] { pose_at({}, x); });
    expect_answer_or_error(named("center", x), [&] { pose_at({{}, {}, {x, 0, 0}}, 0.5); });
  }
  for (const Pose& pose : odd_poses()) {
    expect_answer_or_error("validate", [&] { validate(pose); });
    expect_answer_or_error("compose", [&] { compose(pose, pose); });
    expect_answer_or_error("pose_at", [&] { pose_at({pose, {}, {}}, 0.5); });
    expect_answer_or_error("pose_at", [&] { pose_at({{}, pose, {1, 2, 3}}, 0.5); });
  }
}

TEST(Misuse, Models) {
  for (const Mesh& mesh : odd_meshes())
    expect_answer_or_error("model", [&] {
      const CollisionModel model(mesh, {.execution = {.threads = 1}});
      EXPECT_GT(automatic_tolerance(model, body()), 0);
    });
  for (const double x : kNumbers)
    expect_answer_or_error(named("spacing", x),
                           [&] { CollisionModel(one_triangle(), {.spacing = x, .execution = {.threads = 1}}); });
  for (const int n : kThreads)
    expect_usage(named("threads", n), [&] { CollisionModel(one_triangle(), {.execution = {.threads = n}}); });
  // A model that was moved from held nothing, and each query of it ended the program.
  CollisionModel first(one_triangle(), {.execution = {.threads = 1}});
  const CollisionModel second = std::move(first);
  EXPECT_EQ(first.bounds().max, second.bounds().max);  // NOLINT(bugprone-use-after-move): moves copy
  EXPECT_GT(first.memory_bytes(), 0);
}

TEST(Misuse, QueriesAtAnyPose) {
  for (const Pose& pose : odd_poses()) {
    const std::vector<Pose> poses{{}, pose};
    const std::vector<RigidMotion> motions{{}, {{}, pose, {}}, {pose, {}, {}}};
    expect_answer_or_error("collide", [&] { collide(body(), pose, body(), {}); });
    expect_answer_or_error("distance", [&] { distance(body(), {}, body(), pose); });
    expect_answer_or_error("contacts", [&] { contacts(body(), pose, body(), pose); });
    expect_answer_or_error("sweep", [&] { sweep(body(), pose, body(), {}); });
    expect_answer_or_error("collide_all", [&] { collide_all(body(), {}, body(), poses, {}, {.threads = 1}); });
    expect_answer_or_error("distance_all", [&] { distance_all(body(), {}, body(), poses, {}, {.threads = 1}); });
    expect_answer_or_error("contacts_all", [&] { contacts_all(body(), {}, body(), poses, {}, {.threads = 1}); });
    expect_answer_or_error("sweep_all", [&] { sweep_all(body(), {}, body(), motions, {}, {.threads = 1}); });
    const DistanceField none;
    expect_answer_or_error("collide_thesis", [&] { collide_thesis(none, pose, none, {}, 1); });
    expect_answer_or_error("thesis_sum", [&] { thesis_sum(none, {}, none, pose); });
  }
}

TEST(Misuse, OptionsOfQueries) {
  const RigidMotion motion{{}, make_pose({0, 0, 1}, 1, {3, 0, 0}), {}};
  for (const double x : kNumbers) {
    const std::string name = named("option", x);
    for (const CollideMode mode : {CollideMode::exact, CollideMode::certified, none_of<CollideMode>()})
      expect_answer_or_error(name, [&] { collide(body(), {}, body(), {}, {.margin = x, .mode = mode}); });
    expect_answer_or_error(name, [&] { distance(body(), {}, body(), {}, {.tolerance = x}); });
    expect_answer_or_error(name, [&] { distance(body(), {}, body(), {}, {.limit = x}); });
    expect_answer_or_error(name, [&] { contacts(body(), {}, body(), {}, {.margin = x}); });
    expect_answer_or_error(name, [&] { sweep(body(), {}, body(), motion, {x}); });
    expect_answer_or_error(name, [&] { sweep(body(), {}, body(), {motion.from, motion.to, {x, x, 0}}); });
    const DistanceField none;
    expect_answer_or_error(name, [&] { collide_thesis(none, {}, none, {}, x); });
  }
  for (const std::int64_t n : kCounts)
    expect_answer_or_error(named("most", n), [&] { contacts(body(), {}, body(), {}, {.most = n}); });
}

TEST(Misuse, Batches) {
  const std::vector<Pose> poses(3);
  const std::vector<RigidMotion> motions(3);
  std::vector<Execution> refused{{.device = -1}, {.backend = none_of<Backend>()}, {.simd = none_of<Simd>()}};
  for (const int n : kThreads)
    for (const Backend backend : {Backend::automatic, Backend::cpu, testing::kEmulated})
      refused.push_back({.threads = n, .backend = backend});
  for (const Execution& execution : refused) {
    const std::string name = named("threads", execution.threads);
    expect_usage(name, [&] { collide_all(body(), {}, body(), poses, {}, execution); });
    expect_usage(name, [&] { distance_all(body(), {}, body(), poses, {}, execution); });
    expect_usage(name, [&] { contacts_all(body(), {}, body(), poses, {}, execution); });
    expect_usage(name, [&] { sweep_all(body(), {}, body(), motions, {}, execution); });
    expect_usage(name, [&] { CollisionModel(one_triangle(), {.execution = execution}); });
    expect_usage(name, [&] { World(body(), {.execution = execution}); });
  }
  for (const Backend backend : {Backend::cuda, testing::kEmulated}) {
    const Execution elsewhere{.backend = backend};
    const CollideOptions certified{.mode = CollideMode::certified};
    expect_usage("certified", [&] { collide_all(body(), {}, body(), poses, certified, elsewhere); });
    expect_usage("distance", [&] { distance_all(body(), {}, body(), poses, {}, elsewhere); });
    expect_usage("contacts", [&] { contacts_all(body(), {}, body(), poses, {}, elsewhere); });
    expect_usage("flight", [&] { World(body(), {.execution = elsewhere}); });
  }
  expect_usage("certified containment",
               [&] { collide_all(body(), {}, body(), poses, {.mode = CollideMode::certified, .containment = true}); });
  expect_answer_or_error("containment", [&] { collide(body(), {}, body(), {}, {.containment = true}); });
  expect_usage("mode", [&] { collide(body(), {}, body(), {}, {.mode = none_of<CollideMode>()}); });
  for (const Backend backend : {Backend::automatic, Backend::cpu, Backend::cuda, testing::kEmulated})
    for (const int device : {-1, 0, 1'000'000}) {
      const Execution batch{1, backend, device};
      expect_answer_or_error("collide_all", [&] { collide_all(body(), {}, body(), poses, {}, batch); });
      expect_answer_or_error("collide_all", [&] {
        collide_all(body(), {}, body(), poses, {.mode = CollideMode::certified}, batch, nullptr);
      });
      expect_answer_or_error("sweep_all", [&] { sweep_all(body(), {}, body(), motions, {}, batch); });
      expect_answer_or_error("none", [&] { EXPECT_TRUE(collide_all(body(), {}, body(), {}, {}, batch).empty()); });
      expect_answer_or_error("none", [&] { EXPECT_TRUE(sweep_all(body(), {}, body(), {}, {}, batch).empty()); });
    }
}

TEST(Misuse, Flights) {
  const auto expect = [](const std::string& name, const FlightOptions& options) {
    expect_answer_or_error(name, [&] {
      World world(body(), options);
      world.add(body(), make_pose({0, 0, 1}, 0, {5, 5, 5}));
      world.add_flier({{-3, -3, -3}, {3, 3, 3}});
      world.run(3);
    });
  };
  for (const FlightMode mode : {FlightMode::sweep, FlightMode::thesis, none_of<FlightMode>()})
    for (const double x : kNumbers) {
      const auto with = [&](double FlightOptions::*member) {
        FlightOptions options;
        options.mode = mode;
        options.execution.threads = 1;
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
    options.execution.threads = n;
    expect_usage(named("threads", n), [&] { World(body(), options); });
  }
}

TEST(Misuse, Worlds) {
  FlightOptions options;
  options.execution.threads = 1;
  World world(body(), options);
  expect_usage("no body", [&] { world.grid(0); });
  expect_usage("no body", [&] { world.grid(std::numeric_limits<std::size_t>::max()); });
  expect_usage("steps", [&] { world.run(-1); });
  expect_answer_or_error("no fliers", [&] { world.run(kMost); });
  for (const Pose& pose : odd_poses()) expect_answer_or_error("add", [&] { world.add(body(), pose); });
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
        World another(body(), options);
        another.add_flier({{0, 0, 0}, {1, 1, 1}});
        another.run(2, [](std::size_t, std::int64_t, const Pose&) { throw 5; });
      },
      int);
}

TEST(Misuse, PathsAndFiles) {
  const TempFolder folder;
  const std::vector<PathPoint> points{{-1, kMost, {kNaN, kInfinite, 0}}, {-1, 0, {}}};
  for (const auto& path :
       {std::filesystem::path(), std::filesystem::path("/"), folder / "a", folder / "no/a.csv", folder / "a.csv"}) {
    expect_answer_or_error("write_path", [&] { write_path(path, points); });
    expect_answer_or_error("write_path", [&] { write_path(path, {}, none_of<Existing>()); });
    expect_answer_or_error("save", [&] { body().save(path); });
    expect_answer_or_error("load", [&] { CollisionModel::load(path); });
  }
}

}  // namespace
}  // namespace standoff
