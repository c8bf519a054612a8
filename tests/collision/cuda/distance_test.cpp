// SPDX-License-Identifier: Apache-2.0
// Distances of many poses by the emulated GPU's kernels have the CPU's bits, in every order of threads, however the
// work is shared among warps.
#include <gtest/gtest.h>

#include <string>

#include "bench/conforming.h"
#include "collision/distance.h"
#include "gpu/emulation/block.h"
#include "scenes/scenes.h"
#include "standoff/collision.h"
#include "standoff/cuda.h"
#include "standoff/testing/emulation.h"
#include "tests/collision/bodies.h"
#include "tests/collision/expect_same.h"

namespace standoff {
namespace {

using namespace standoff::testing;
using collision::DistanceLists;
using emulation::Order;
using emulation::OrderScope;

constexpr double kFar = std::numeric_limits<double>::infinity();
const Execution kOnEmulatedGpu{.threads = 2, .backend = testing::kEmulated};

struct DistanceCounts {
  int touching = 0, beyond = 0;
  BatchReport report;
};

DistanceCounts expect_as_cpu(const Body& a, const Pose& pose_a, const Body& b, const std::vector<Pose>& poses,
                             double limit = kFar, const DistanceLists& lists = {}) {
  const auto expected = distance_all(a, pose_a, b, poses, {.limit = limit}, {.backend = Backend::cpu}).results;
  DistanceCounts counts;
  const auto found = collision::distance_on_device(*collision::find_device(testing::kEmulated, poses.size()), a, pose_a,
                                                   b, poses, limit, kOnEmulatedGpu, counts.report, lists);
  EXPECT_EQ(found.size(), poses.size());
  for (std::size_t n = 0; n < poses.size(); ++n) {
    SCOPED_TRACE("pose " + std::to_string(n));
    expect_same(found[n], expected[n]);
    counts.touching += expected[n].upper == 0, counts.beyond += expected[n].upper == kFar;
  }
  EXPECT_EQ(counts.report.on_device + counts.report.undecided + counts.report.overflowed,
            static_cast<std::int64_t>(poses.size()));
  return counts;
}

std::vector<Pose> poses_within(unsigned seed, int count, double half, Vec3 around = {}) {
  Random random(seed);
  std::vector<Pose> poses;
  for (int n = 0; n < count; ++n) {
    poses.push_back(random_pose(random, half));
    poses.back().translation = poses.back().translation + around;
  }
  return poses;
}

// All that does not touch is decided on the device.
void expect_decided(const DistanceCounts& counts, int poses, const std::string& what = {}) {
  EXPECT_EQ(counts.report.on_device, poses - counts.touching) << what;
  EXPECT_EQ(counts.report.overflowed, 0) << what;
}

TEST(CudaDistance, HasTheBitsOfTheCpu) {
  const Body ball(ball_mesh(1, 12)), soup(random_soup(4, 300, 1, 0.2)), small(random_soup(5, 60, 0.4, 0.3));
  for (const Order order : {Order::forward, Order::reverse, Order::random}) {
    SCOPED_TRACE("order " + std::to_string(static_cast<int>(order)));
    const OrderScope scope(order, 11);
    const DistanceCounts balls = expect_as_cpu(ball, {}, small, poses_within(1, 120, 2.5));
    expect_decided(balls, 120);
    EXPECT_GT(balls.touching, 10);
    const DistanceCounts soups = expect_as_cpu(soup, {}, small, poses_within(2, 120, 2.5));
    expect_decided(soups, 120);
    EXPECT_GT(soups.touching, 10);
  }
}

// A warp hands over after one step or after two, to lists with and without room.
TEST(CudaDistance, ManyWarpsSearchForOnePose) {
  const Body ball(ball_mesh(1, 20)), soup(random_soup(6, 2000, 1.3, 0.1));
  const std::vector<Pose> poses = poses_within(3, 6, 1, {0, 0, 3.5});
  for (const Order order : {Order::forward, Order::reverse, Order::random}) {
    const OrderScope scope(order, 12);
    for (const int turn : {1, 2, 7})
      for (const std::uint32_t handed : {0u, 5u, 40u, 1u << 12})
        expect_decided(expect_as_cpu(ball, {}, soup, poses, kFar, {.turn = turn, .handed = handed}), 6,
                       std::to_string(turn) + " " + std::to_string(handed));
  }
}

// What is near is found soon, and drops the rest, by one warp and by many: of ten million pairs few are measured.
TEST(CudaDistance, LooksAtFewPairs) {
  const Body a(ball_mesh(1, 20)), b(ball_mesh(1, 20));
  const Pose pose = make_pose({1, 2, 3}, 0.4, {2.1, 0.3, 0.2});
  const collision::QueryPair pair(a, {}, b, pose, collision::best_kernels());
  const std::vector<collision::DistanceQuery> queries{collision::query_of(pair)};
  for (const int turn : {4, 1 << 20}) {
    std::vector<collision::DistanceAnswer> answers(1);
    collision::find_device(testing::kEmulated, 1)
        ->distance({.target = *pair.target.body,
                    .probe = *pair.probe.body,
                    .target_is_b = pair.swapped,
                    .probe_is_small = pair.probe_is_small(),
                    .of_a = collision::transform_of({}),
                    .limit = kFar,
                    .queries = queries,
                    .answers = answers,
                    .device = 0,
                    .lists = {.turn = turn}});
    EXPECT_GT(answers[0].measured, 0u);
    EXPECT_LT(answers[0].measured, 1000u);
    EXPECT_LT(answers[0].node_pairs, 300u);
  }
}

TEST(CudaDistance, WithinALimit) {
  const Body ball(ball_mesh(1, 8)), soup(random_soup(7, 100, 1, 0.2)), small(ball_mesh(0.5, 3));
  const std::vector<Pose> poses = poses_within(4, 80, 4);
  for (const double limit : {0.0, 0.3, 1.0, 1e3}) {
    SCOPED_TRACE(limit);
    const DistanceCounts counts = expect_as_cpu(ball, {}, small, poses, limit);
    expect_decided(counts, 80);
    EXPECT_EQ(counts.beyond == 0, limit == 1e3);
    expect_decided(expect_as_cpu(soup, {}, small, poses, limit), 80);
  }
  // The limit is exclusive: a pair as far apart is not found, one a rounding nearer is.
  const Body triangle(one_triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}));
  const std::vector<Pose> above{moved({4, 0, 4})};
  const double apart = distance(triangle, {}, triangle, above[0]).upper;
  EXPECT_EQ(expect_as_cpu(triangle, {}, triangle, above, apart).beyond, 1);
  EXPECT_EQ(expect_as_cpu(triangle, {}, triangle, above, std::nextafter(apart, kFar)).beyond, 0);
}

TEST(CudaDistance, BothBodiesMovedAndEitherTheLarger) {
  const Body large(ball_mesh(1, 9)), small(random_soup(8, 60, 0.4, 0.4));
  Random random(9);
  for (int n = 0; n < 3; ++n) {
    const Pose pose = random_pose(random, 5);
    const std::vector<Pose> poses = poses_within(10 + n, 60, 2.5, pose.translation);
    expect_decided(expect_as_cpu(large, pose, small, poses), 60);
    expect_decided(expect_as_cpu(small, pose, large, poses), 60);
  }
}

// Corners on a lattice: many pairs are exactly as near as each other, touch, or cross within rounding.
TEST(CudaDistance, TiesAndTouchesOnALattice) {
  Random random(13);
  std::vector<Pose> poses;
  constexpr std::array<std::array<double, 9>, 3> kTurns{
      {{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, -1, 0, 1, 0, 0, 0, 0, 1}, {0, 0, 1, 0, 1, 0, -1, 0, 0}}};
  for (int n = 0; n < 150; ++n) {
    const Vec3 at = random.in_cube(7);
    poses.push_back({kTurns[n % 3], {std::round(at.x), std::round(at.y), std::round(at.z)}});
  }
  const Body a(nasty_soup(1, 60, 2)), b(nasty_soup(2, 40, 2));
  for (const Order order : {Order::forward, Order::reverse, Order::random}) {
    const OrderScope scope(order, 13);
    const DistanceCounts counts = expect_as_cpu(a, {}, b, poses, kFar, {.turn = 1});
    EXPECT_GT(counts.report.on_device, 30);
    EXPECT_GT(counts.touching, 15);
  }
}

// Which of many copies is reported follows the order of triangles; of very many the CPU has a proof, and reports
// others.
TEST(CudaDistance, Copies) {
  for (const std::size_t count : {5, 30, 70, 200}) {
    Mesh copies{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {}};
    copies.triangles.assign(count, {0, 1, 2});
    const Body stack(copies), other(one_triangle({0, 0, 0}, {1, 0.1, 0}, {0, 1, 0.2}));
    const DistanceCounts of_stacks = expect_as_cpu(stack, {}, stack, poses_within(14, 12, 2));
    EXPECT_EQ(of_stacks.report.on_device > 0, count < 65) << count;
    expect_as_cpu(stack, {}, other, poses_within(15, 12, 2));
  }
}

TEST(CudaDistance, FansSliversAndSingleTriangles) {
  const Body fan(bench::make_conforming("fan:1", 150)), down(bench::make_conforming("fan:-1", 100)),
      one(one_triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0})), sliver(one_triangle({0, 0, 0}, {5, 1e-9, 0}, {5, 0, 1e-12})),
      point(one_triangle({0.1, 0.2, 0.3}, {0.1, 0.2, 0.3}, {0.1, 0.2, 0.3}));
  const std::vector<Pose> poses = poses_within(16, 40, 3);
  for (const Body* a : {&fan, &down, &one, &sliver, &point})
    for (const Body* b : {&fan, &down, &one, &sliver, &point}) expect_as_cpu(*a, {}, *b, poses);
  std::vector<Pose> above;
  for (const double gap : {1.0, 1e-3, 1e-9, 1e-15, 0.0}) above.push_back(moved({0, gap, 0}));
  expect_as_cpu(down, {}, fan, above);
}

// Surfaces that run side by side: nothing separates nested shells, so no proof can end the CPU's search, and the device
// decides them however many pairs are about equally near. Plates are left to the CPU.
TEST(CudaDistance, ConformingSurfaces) {
  const Body outer(bench::make_conforming("shell:1", 3000)), inner(bench::make_conforming("shell:0.97", 3000)),
      plate(bench::make_conforming("plate", 600));
  Random random(17);
  std::vector<Pose> turned, above;
  for (int n = 0; n < 3; ++n) {
    turned.push_back(make_pose(random.in_cube(1), random.between(0, 3), random.in_cube(1e-3)));
    above.push_back(make_pose({0, 1, 0}, random.between(0, 3), {0, 0.2 + 1e-4 * n, 0}));
  }
  const DistanceCounts shells = expect_as_cpu(outer, {}, inner, turned);
  EXPECT_EQ(shells.touching, 0);
  expect_decided(shells, 3);
  expect_decided(expect_as_cpu(outer, {}, inner, turned, 0.5, {.turn = 3}), 3);
  EXPECT_EQ(expect_as_cpu(plate, {}, plate, above).report.on_device, 0);
  const Pose tilted = make_pose({1, 0.2, 0.4}, 0.7, {});
  for (Pose& pose : above) pose = compose(tilted, pose);
  expect_as_cpu(plate, tilted, plate, above);
}

TEST(CudaDistance, ScenesAndSmallProbes) {
  const Body maze(scenes::make("labyrinth", 2000)), fly(scenes::make("fly", 300)),
      speck(one_triangle({0, 0, 0}, {0.01, 0, 0}, {0, 0.01, 0}));
  const Box box = maze.bounds();
  Random random(18);
  std::vector<Pose> poses = poses_within(19, 60, 1);
  for (Pose& pose : poses)
    pose.translation =
        box.center() + Vec3{random.between(-0.5, 0.5), random.between(-0.5, 0.5), random.between(0, 1)} * box.extent();
  // Above the walls a plane separates the bodies, which the CPU takes for a proof.
  EXPECT_GT(expect_as_cpu(maze, {}, fly, poses).report.on_device, 30);
  EXPECT_GT(expect_as_cpu(maze, {}, speck, poses).report.on_device, 30);
}

TEST(CudaDistance, FarFromTheOriginAndInOtherUnits) {
  for (const double unit : {1e-9, 1e9}) {
    SCOPED_TRACE(unit);
    const Vec3 far = Vec3{3e3, -2e4, 77} * unit;
    const Body large(ball_mesh(unit, 5, far)), small(random_soup(20, 60, 0.6 * unit, 0.3 * unit));
    std::vector<Pose> poses = poses_within(21, 60, 3);
    for (Pose& pose : poses) pose.translation = pose.translation * unit + far;
    expect_decided(expect_as_cpu(large, {}, small, poses), 60);
    expect_decided(expect_as_cpu(large, {}, small, poses_within(22, 20, 3e3 * unit)), 20);
    expect_as_cpu(large, {}, small, poses_within(22, 20, 1e6 * unit));  // all pairs are about as near
  }
}

TEST(CudaDistance, WhereTheListsAreFullTheCpuAnswers) {
  const Body ball(ball_mesh(1, 12)), soup(random_soup(23, 600, 1, 0.2));
  const std::vector<Pose> poses = poses_within(24, 40, 3);
  EXPECT_EQ(expect_as_cpu(ball, {}, soup, poses, kFar, {.stack = 34}).report.overflowed, 0);  // others take it over
  EXPECT_GT(expect_as_cpu(ball, {}, soup, poses, kFar, {.stack = 34, .handed = 0}).report.overflowed, 0);
  EXPECT_GT(expect_as_cpu(ball, {}, soup, poses, kFar, {.stack = 2}).report.overflowed, 10);
}

TEST(CudaDistance, ThePublicCallSaysWhatItDid) {
  const Body a(ball_mesh(1, 4)), b(ball_mesh(0.5, 3));
  const std::vector<Pose> poses = poses_within(25, 30, 3);
  const auto [found, report] = distance_all(a, {}, b, poses, {}, kOnEmulatedGpu);
  expect_same(found, distance_all(a, {}, b, poses, {}, {.threads = 1}).results);
  EXPECT_EQ(report.backend, "emulated");
  EXPECT_GT(report.on_device, 10);
  EXPECT_GT(report.undecided, 0);
  const auto none = distance_all(a, {}, b, {}, {}, kOnEmulatedGpu);
  EXPECT_TRUE(none.results.empty());
  EXPECT_EQ(distance_all(a, {}, b, poses, {.tolerance = 0.1}, {.backend = Backend::automatic}).report.backend, "cpu");
  const auto code = [&](const DistanceOptions& options, const Execution& execution) {
    return code_of([&] { static_cast<void>(distance_all(a, {}, b, poses, options, execution)); });
  };
  EXPECT_EQ(code({.tolerance = 0.1}, kOnEmulatedGpu), ErrorCode::usage);
  EXPECT_EQ(code({.max_steps = 10}, kOnEmulatedGpu), ErrorCode::usage);
  EXPECT_EQ(code({.limit = -1}, kOnEmulatedGpu), ErrorCode::usage);
  if (cuda::devices().empty()) {
    EXPECT_EQ(code({}, {.backend = Backend::cuda}), ErrorCode::device);
  }
}

}  // namespace
}  // namespace standoff
