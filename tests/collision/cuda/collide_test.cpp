// SPDX-License-Identifier: Apache-2.0
// Verdicts for many poses by the emulated GPU's kernels equal the CPU's, in every order of threads.
#include <gtest/gtest.h>

#include <string>

#include "collision/collide.h"
#include "gpu/emulation/block.h"
#include "scenes/scenes.h"
#include "standoff/collision.h"
#include "standoff/cuda.h"
#include "standoff/testing/emulation.h"
#include "tests/collision/bodies.h"

namespace standoff {
namespace {

using namespace standoff::testing;
using emulation::Order;
using emulation::OrderScope;

constexpr Order kOrders[] = {Order::forward, Order::reverse, Order::random};
const Execution kEmulation{.threads = 2, .backend = testing::kEmulated};

struct Counts {
  int hits = 0;
  BatchReport report;
};

void expect_touching(const Body& a, const Pose& pose_a, const Body& b, const Pose& pose_b, const CollisionResult& found,
                     double margin) {
  const Corners p = corners_at(a.mesh(), found.triangle_a, pose_a), q = corners_at(b.mesh(), found.triangle_b, pose_b);
  EXPECT_TRUE(triangles_intersect(p, q) || closest_points(p, q).distance_sq <= margin * margin);
}

Counts expect_as_cpu(const Body& a, const Pose& pose_a, const Body& b, const std::vector<Pose>& poses,
                     double margin = 0, int stack = collision::kDeviceStack) {
  const auto expected = collide_all(a, pose_a, b, poses, {.margin = margin}, {.backend = Backend::cpu}).results;
  Counts counts;
  counts.report.backend = "emulated";
  const auto found = collision::collide_on_device(*collision::find_device(testing::kEmulated, poses.size()), a, pose_a,
                                                  b, poses, margin, kEmulation, counts.report, stack);
  EXPECT_EQ(found.size(), poses.size());
  for (std::size_t n = 0; n < poses.size(); ++n) {
    EXPECT_EQ(found[n].verdict, expected[n].verdict) << "pose " << n;
    if (found[n].hit()) expect_touching(a, pose_a, b, poses[n], found[n], margin);
    counts.hits += expected[n].hit();
  }
  EXPECT_LE(counts.report.on_device + counts.report.undecided + counts.report.overflowed,
            static_cast<std::int64_t>(poses.size()));
  return counts;
}

std::vector<Pose> random_poses(unsigned seed, int count, double half) {
  Random random(seed);
  std::vector<Pose> poses;
  for (int n = 0; n < count; ++n) poses.push_back(random_pose(random, half));
  return poses;
}

void expect_both(const Counts& counts, int poses) {
  EXPECT_GT(counts.hits, poses / 10);
  EXPECT_LT(counts.hits, poses * 9 / 10);
  EXPECT_EQ(counts.report.overflowed, 0);
}

TEST(CudaCollide, AgreesWithTheCpu) {
  const Body ball(ball_mesh(1, 12)), soup(random_soup(4, 300, 1, 0.2)), small(ball_mesh(0.7, 5));
  for (const Order order : kOrders) {
    SCOPED_TRACE("order " + std::to_string(static_cast<int>(order)));
    const OrderScope scope(order, 11);
    expect_both(expect_as_cpu(ball, {}, small, random_poses(1, 600, 1.7)), 600);
    expect_both(expect_as_cpu(soup, {}, small, random_poses(2, 600, 2.2)), 600);
  }
}

TEST(CudaCollide, AgreesWithTheCpuWithinAMargin) {
  const Body ball(ball_mesh(1, 8)), soup(random_soup(3, 100, 1, 0.2)), small(ball_mesh(0.5, 3));
  for (const double margin : {1e-6, 0.05, 0.4}) {
    SCOPED_TRACE("margin " + std::to_string(margin));
    expect_both(expect_as_cpu(ball, {}, small, random_poses(3, 300, 2), margin), 300);
    expect_both(expect_as_cpu(soup, {}, small, random_poses(4, 300, 2.2), margin), 300);
  }
}

TEST(CudaCollide, BothBodiesMovedAndEitherTheLarger) {
  const Body large(ball_mesh(1, 7)), small(random_soup(5, 60, 0.4, 0.4));
  Random random(6);
  for (int n = 0; n < 3; ++n) {
    const Pose pose = random_pose(random, 1);
    std::vector<Pose> poses = random_poses(7 + n, 200, 2);
    for (Pose& other : poses) other.translation = other.translation + pose.translation;
    expect_both(expect_as_cpu(large, pose, small, poses), 200);
    expect_both(expect_as_cpu(small, pose, large, poses), 200);
  }
}

// Corners on a lattice: planes and edges fall together, so that determinants are zero or less than rounding.
TEST(CudaCollide, TouchingExactly) {
  Random random(8);
  std::vector<Pose> poses;
  constexpr std::array<std::array<double, 9>, 3> kTurns{
      {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, -1, 0, 1, 0, 0, 0, 0, 1}, {0, 0, 1, 0, 1, 0, -1, 0, 0}}};
  for (int n = 0; n < 300; ++n) {
    const Vec3 at = random.in_cube(5);
    poses.push_back({kTurns[n % 3], {std::round(at.x), std::round(at.y), std::round(at.z)}});
  }
  const Body a(nasty_soup(1, 40, 2)), b(nasty_soup(2, 20, 2));
  std::int64_t undecided = 0;
  for (const double margin : {0.0, 0.5}) {
    const Counts counts = expect_as_cpu(a, {}, b, poses, margin);
    expect_both(counts, 300);
    undecided += counts.report.undecided;
  }
  EXPECT_GT(undecided, 10);

  const Body lower(one_triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0})),
      upper(one_triangle({0, 0, 0}, {-1, 0, 1}, {-1, 1, 1}));
  const double next = std::nextafter(1.0, 2.0);
  const Counts counts = expect_as_cpu(lower, {}, upper,
                                      {{.translation = {1, 0, 0}},
                                       {.translation = {next, 0, 0}},
                                       {.translation = {0.25, 0.25, 0}},
                                       {.translation = {0.25, 0.25, 1e-80}},
                                       {.translation = {0.5, 0.25, -0.25}}});
  EXPECT_EQ(counts.hits, 3);
}

TEST(CudaCollide, ScenesAndOneTriangle) {
  const Body maze(scenes::make("labyrinth", 2000)), fly(scenes::make("fly", 300));
  const Box box = maze.bounds();
  Random random(9);
  std::vector<Pose> poses = random_poses(10, 150, 1);
  for (Pose& pose : poses)
    pose.translation =
        box.center() +
        Vec3{random.between(-0.5, 0.5), random.between(-0.5, 0.5), random.between(-0.5, 0.5)} * box.extent();
  const Counts counts = expect_as_cpu(maze, {}, fly, poses);
  expect_both(counts, 150);
  EXPECT_GT(counts.report.on_device, 100);
  const Body point(one_triangle({0, 0, 0}, {0.3, 0, 0}, {0, 0.3, 0}));
  expect_as_cpu(maze, {}, point, poses);
}

TEST(CudaCollide, FarFromTheOriginAndInOtherUnits) {
  for (const double unit : {1e-9, 1e9}) {
    Mesh a = ball_mesh(unit, 5), b = random_soup(11, 60, 0.6 * unit, 0.3 * unit);
    const Vec3 far = Vec3{3e3, -2e4, 77} * unit;
    for (Vec3& v : a.vertices) v = v + far;
    std::vector<Pose> poses = random_poses(12, 100, 1.8);
    for (Pose& pose : poses) pose.translation = pose.translation * unit + far;
    expect_both(expect_as_cpu(Body(a), {}, Body(b), poses), 100);
  }
}

TEST(CudaCollide, WhereTheStackIsFullTheCpuAnswers) {
  const Body ball(ball_mesh(1, 12)), soup(random_soup(13, 600, 1, 0.2));
  const std::vector<Pose> poses = random_poses(14, 120, 1.2);
  std::int64_t before = 0;
  for (const int stack : {40, 12, 2}) {
    const Counts counts = expect_as_cpu(ball, {}, soup, poses, 0, stack);
    EXPECT_GE(counts.report.overflowed, before) << stack;
    before = counts.report.overflowed;
  }
  EXPECT_GT(before, 30);
  // The BVH of a single triangle never waits on the stack: the boxes of the other body overflow.
  const Body one(one_triangle({0, 0, 0}, {0.3, 0, 0}, {0, 0.3, 0}));
  EXPECT_GT(expect_as_cpu(soup, {}, one, poses, 0, 2).report.overflowed, 20);
}

TEST(CudaCollide, ThePublicCallSaysWhatItDid) {
  const Body a(ball_mesh(1, 4)), b(ball_mesh(0.5, 3));
  const std::vector<Pose> poses = random_poses(15, 20, 1.3);
  const auto [found, report] = collide_all(a, {}, b, poses, {}, kEmulation);
  const auto expected = collide_all(a, {}, b, poses, {}, {.threads = 1}).results;
  for (std::size_t n = 0; n < poses.size(); ++n) EXPECT_EQ(found[n].verdict, expected[n].verdict);
  EXPECT_EQ(report.backend, "emulated");
  EXPECT_GT(report.on_device, 0);
  const auto none = collide_all(a, {}, b, {}, {}, kEmulation);
  EXPECT_TRUE(none.results.empty());
  EXPECT_EQ(none.report.on_device, 0);
  EXPECT_EQ(collide_all(a, {}, b, poses, {}, {.threads = 1}).report.backend, "cpu");
  EXPECT_EQ(collide_all(a, {}, b, poses, {}, {.backend = Backend::automatic}).report.backend, "cpu");
  EXPECT_EQ(distance_all(a, {}, b, poses).report.backend, "cpu");
  EXPECT_EQ(contacts_all(a, {}, b, poses).report.backend, "cpu");
}

TEST(CudaCollide, Errors) {
  const Body a(ball_mesh(1, 2));
  std::vector<Pose> poses(3);
  const auto run = [&](const CollideOptions& options, const Execution& batch) {
    return code_of([&] { static_cast<void>(collide_all(a, {}, a, poses, options, batch).results); });
  };
  if (cuda::devices().empty()) {
    EXPECT_EQ(run({}, {.backend = Backend::cuda}), ErrorCode::device);
  }
  EXPECT_EQ(run({.mode = CollideMode::certified}, kEmulation), ErrorCode::usage);
  EXPECT_EQ(run({.margin = -1}, kEmulation), ErrorCode::usage);
  EXPECT_EQ(run({}, {.threads = -1, .backend = testing::kEmulated}), ErrorCode::usage);
  poses[2].translation.x = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(run({}, kEmulation), ErrorCode::usage);
}

TEST(CudaCollide, ABodyIsCopiedToADeviceOnce) {
  const Body a(ball_mesh(1, 3)), b(ball_mesh(0.5, 3));
  const Body shared = a;
  const std::vector<Pose> poses = random_poses(16, 4, 1);
  static_cast<void>(collide_all(a, {}, b, poses, {}, kEmulation).results);
  const auto never = []() -> std::shared_ptr<const gpu::DeviceCopy> {
    ADD_FAILURE() << "copied again";
    return nullptr;
  };
  std::weak_ptr<const gpu::DeviceCopy> copy =
      collision::data_of(shared).device_bodies.get(testing::kEmulated, 0, never);
  EXPECT_FALSE(copy.expired());
  {
    const Body gone(ball_mesh(1, 3));
    static_cast<void>(collide_all(gone, {}, b, poses, {}, kEmulation).results);
    copy = collision::data_of(gone).device_bodies.get(testing::kEmulated, 0, never);
    EXPECT_FALSE(copy.expired());
  }
  EXPECT_TRUE(copy.expired());
}

}  // namespace
}  // namespace standoff
