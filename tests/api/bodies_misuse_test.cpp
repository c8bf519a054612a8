// SPDX-License-Identifier: Apache-2.0
// collision.h and pose.h with arguments that make no sense.
#include "standoff/collision.h"
#include "standoff/testing/emulation.h"
#include "standoff/thesis.h"
#include "tests/api/misuse.h"
#include "tests/support/temp_folder.h"

namespace standoff {
namespace {

using namespace testing;

const Body& body() {
  static const Body model(one_triangle(), {.execution = {.threads = 1}});
  return model;
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
      const Body model(mesh, {.execution = {.threads = 1}});
      EXPECT_GT(automatic_tolerance(model, body()), 0);
    });
  for (const double x : kNumbers)
    expect_answer_or_error(named("spacing", x),
                           [&] { Body(one_triangle(), {.spacing = x, .execution = {.threads = 1}}); });
  for (const int n : kThreads)
    expect_usage(named("threads", n), [&] { Body(one_triangle(), {.execution = {.threads = n}}); });
  // A model that was moved from held nothing, and each query of it ended the program.
  Body first(one_triangle(), {.execution = {.threads = 1}});
  const Body second = std::move(first);
  EXPECT_EQ(first.bounds().max, second.bounds().max);  // NOLINT(bugprone-use-after-move): moves copy
  EXPECT_GT(first.memory_bytes(), 0);
}

TEST(Misuse, QueriesAtAnyPose) {
  for (const Pose& pose : odd_poses()) {
    const std::vector<Pose> poses{{}, pose};
    const std::vector<RigidMotion> motions{{}, {{}, pose, {}}, {pose, {}, {}}};
    expect_answer_or_error("collide", [&] { collide(body(), pose, body(), {}); });
    expect_answer_or_error("distance", [&] { distance(body(), {}, body(), pose); });
    DistanceState state{7, 1'000'000, -1};
    expect_answer_or_error("distance", [&] { distance(body(), {}, body(), pose, {}, state); });
    expect_answer_or_error("contacts", [&] { contacts(body(), pose, body(), pose); });
    expect_answer_or_error("sweep", [&] { sweep(body(), pose, body(), {}); });
    expect_answer_or_error("collide_all", [&] { collide_all(body(), {}, body(), poses, {}, {.threads = 1}); });
    expect_answer_or_error("distance_all", [&] { distance_all(body(), {}, body(), poses, {}, {.threads = 1}); });
    expect_answer_or_error("contacts_all", [&] { contacts_all(body(), {}, body(), poses, {}, {.threads = 1}); });
    expect_answer_or_error("sweep_all", [&] { sweep_all(body(), {}, body(), motions, {}, {.threads = 1}); });
    expect_answer_or_error("sweep_path", [&] { sweep_path(body(), {}, body(), motions); });
    expect_answer_or_error("sweep_spline", [&] { sweep_spline(body(), pose, body(), {.start = pose}); });
    expect_answer_or_error("screw_motion", [&] { sweep(body(), {}, body(), screw_motion(pose, {}, {0, 0, 1}, 9)); });
    const DistanceField none;
    expect_answer_or_error("collide_thesis", [&] { collide_thesis(none, pose, none, {}, 1); });
    expect_answer_or_error("thesis_sum", [&] { thesis_sum(none, {}, none, pose); });
    expect_answer_or_error("ThesisField", [&] { thesis_sum(ThesisField(none), pose, ThesisField(none), {}); });
    expect_answer_or_error("MinimumField", [&] { MinimumField(one_triangle(), 1).at(pose); });
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
    expect_answer_or_error(name, [&] { sweep(body(), {}, body(), {motion.start, motion.end, {x, x, 0}}); });
    expect_answer_or_error(name, [&] { spline_pose_at({.axis = {0, 1, 1}, .angle_rad = x}, 0.5); });
    expect_answer_or_error(name, [&] { sweep_spline(body(), {}, body(), {.control = {Vec3{x, 0, 5}}}, {x}); });
    expect_answer_or_error(name, [&] { pose_at({{}, {}, {}, {0, 0, 1}, x}, 0.5); });
    expect_answer_or_error(name, [&] { sweep(body(), {}, body(), {{}, {}, {}, {x, 0, 1}, 1}); });
    expect_answer_or_error(name, [&] { sweep(body(), {}, body(), screw_motion({}, {x, 1, 1}, {0, 0, 1}, 9)); });
    expect_answer_or_error(name, [&] { sweep(body(), {}, body(), screw_motion({}, {}, {0, 1, x}, 9, 1)); });
    expect_answer_or_error(name, [&] { sweep(body(), {}, body(), screw_motion({}, {}, {0, 0, 1}, x, 1)); });
    expect_answer_or_error(name, [&] { sweep(body(), {}, body(), screw_motion({}, {}, {0, 0, 1}, 9, x)); });
    const DistanceField none;
    expect_answer_or_error(name, [&] { collide_thesis(none, {}, none, {}, x); });
    expect_answer_or_error(name, [&] { collide_thesis(ThesisField(none), {}, ThesisField(none), {}, x); });
    expect_answer_or_error(name, [&] { MinimumField(one_triangle(), x); });
    expect_answer_or_error(name, [&] { MinimumField(one_triangle(), 1, x); });
    expect_answer_or_error(name, [&] { MinimumField(one_triangle(), 1, 2, x); });
  }
  for (const std::int64_t n : kCounts) {
    expect_answer_or_error(named("most", n), [&] { contacts(body(), {}, body(), {}, {.most = n}); });
    expect_answer_or_error(named("max_steps", n), [&] { sweep(body(), {}, body(), motion, {.max_steps = n}); });
    expect_answer_or_error(named("max_steps", n), [&] {
      sweep_path(body(), {}, body(), std::vector{motion, motion}, {.max_steps = n});
    });
    expect_answer_or_error(named("max_steps", n), [&] { distance(body(), {}, body(), {}, {.max_steps = n}); });
  }
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
    expect_usage(name, [&] { Body(one_triangle(), {.execution = execution}); });
    expect_usage(name, [&] { ThesisField(DistanceField(), execution); });
    expect_usage(name, [&] { MinimumField(one_triangle(), 1, 2, 0, execution); });
  }
  for (const Backend backend : {Backend::cuda, testing::kEmulated}) {
    const Execution elsewhere{.backend = backend};
    const CollideOptions certified{.mode = CollideMode::certified};
    expect_usage("certified", [&] { collide_all(body(), {}, body(), poses, certified, elsewhere); });
    expect_usage("tolerance", [&] { distance_all(body(), {}, body(), poses, {.tolerance = 1}, elsewhere); });
    expect_usage("max_steps", [&] { distance_all(body(), {}, body(), poses, {.max_steps = 1}, elsewhere); });
    expect_usage("contacts", [&] { contacts_all(body(), {}, body(), poses, {}, elsewhere); });
  }
  expect_usage("certified containment",
               [&] { collide_all(body(), {}, body(), poses, {.mode = CollideMode::certified, .containment = true}); });
  expect_answer_or_error("containment", [&] { collide(body(), {}, body(), {}, {.containment = true}); });
  expect_usage("mode", [&] { collide(body(), {}, body(), {}, {.mode = none_of<CollideMode>()}); });
  for (const Backend backend : {Backend::automatic, Backend::cpu, Backend::cuda, testing::kEmulated})
    for (const int device : {-1, 0, 1'000'000}) {
      const Execution batch{1, backend, device};
      expect_answer_or_error("collide_all", [&] { collide_all(body(), {}, body(), poses, {}, batch); });
      expect_answer_or_error("collide_all",
                             [&] { collide_all(body(), {}, body(), poses, {.mode = CollideMode::certified}, batch); });
      expect_answer_or_error("distance_all", [&] { distance_all(body(), {}, body(), poses, {}, batch); });
      expect_answer_or_error("none",
                             [&] { EXPECT_TRUE(distance_all(body(), {}, body(), {}, {}, batch).results.empty()); });
      expect_answer_or_error("sweep_all", [&] { sweep_all(body(), {}, body(), motions, {}, batch); });
      expect_answer_or_error("none",
                             [&] { EXPECT_TRUE(collide_all(body(), {}, body(), {}, {}, batch).results.empty()); });
      expect_answer_or_error("none",
                             [&] { EXPECT_TRUE(sweep_all(body(), {}, body(), {}, {}, batch).results.empty()); });
    }
}

TEST(Misuse, Files) {
  const TempFolder folder;
  for (const auto& path :
       {std::filesystem::path(), std::filesystem::path("/"), folder / "a", folder / "no/a.csv", folder / "a.csv"}) {
    expect_answer_or_error("save", [&] { body().save(path); });
    expect_answer_or_error("load", [&] { Body::load(path); });
  }
}

}  // namespace
}  // namespace standoff
