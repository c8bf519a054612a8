// SPDX-License-Identifier: Apache-2.0
// A distance query that begins with a state has the bits of one that does not, whatever the state is from.
#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "standoff/collision.h"
#include "tests/collision/bodies.h"
#include "tests/collision/expect_same.h"
#include "tests/support/sanitized.h"

namespace standoff {
namespace {

using namespace standoff::testing;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Mesh cube_mesh(int cuts) {
  Mesh mesh;
  const auto face = [&](Vec3 corner, Vec3 right, Vec3 up) {
    for (int i = 0; i < cuts; ++i)
      for (int j = 0; j < cuts; ++j) {
        const auto at = [&](int x, int y) { return corner + right * (1.0 * x / cuts) + up * (1.0 * y / cuts); };
        add_triangle(mesh, at(i, j), at(i + 1, j), at(i, j + 1));
        add_triangle(mesh, at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
      }
  };
  for (const double side : {0.0, 1.0}) {
    face({side, 0, 0}, {0, 1, 0}, {0, 0, 1});
    face({0, side, 0}, {0, 0, 1}, {1, 0, 0});
    face({0, 0, side}, {1, 0, 0}, {0, 1, 0});
  }
  return mesh;
}

struct Pair {
  Body a, b;
  Pair(const Mesh& mesh_a, const Mesh& mesh_b) : a(mesh_a), b(mesh_b) {}
};

// Queries at a pose with states of all kinds. A state with an infinite distance is always begun with.
void expect_same_with_any_state(const Pair& pair, const Pose& pose_a, const Pose& pose_b, Random& random,
                                DistanceState& followed, const DistanceOptions& options = {}) {
  const DistanceResult expected = distance(pair.a, pose_a, pair.b, pose_b, options);
  expect_same(distance(pair.a, pose_a, pair.b, pose_b, options, followed), expected);
  DistanceState of_this_pose = followed;
  expect_same(distance(pair.a, pose_a, pair.b, pose_b, options, of_this_pose), expected);
  const auto index = [&](const Body& body) {
    return static_cast<std::uint32_t>(random.between(0, 1.2 * static_cast<double>(body.mesh().triangles.size())));
  };
  for (int n = 0; n < 6; ++n) {
    DistanceState any{index(pair.a), index(pair.b), n % 2 ? kInfinity : random.between(0, 2)};
    if (n % 3 == 0) any = {followed.of_target, followed.of_probe, kInfinity};
    expect_same(distance(pair.a, pose_a, pair.b, pose_b, options, any), expected);
  }
}

// A walk in steps of a length, from a random place; every tenth is a jump.
void expect_same_on_a_walk(const Mesh& a, const Mesh& b, int steps, double half, double step, unsigned seed,
                           const DistanceOptions& options = {}) {
  const Pair pair(a, b);
  Random random(seed);
  DistanceState followed;
  Vec3 at = random.in_cube(half), axis = random.in_cube(1) + Vec3{0, 0, 1e-3};
  double angle = 0;
  for (int n = 0; n < steps; ++n) {
    if (n % 10 == 9) at = random.in_cube(half), axis = random.in_cube(1) + Vec3{0, 0, 1e-3};
    at = at + random.in_cube(step), angle += step * random.between(0, 1);
    expect_same_with_any_state(pair, n % 20 < 10 ? Pose{} : moved({0.1, 0.2, 0.3}), make_pose(axis, angle, at), random,
                               followed, options);
  }
}

TEST(DistanceState, ChangesNoBit) {
  expect_same_on_a_walk(random_soup(3, 200, 1, 0.2), ball_mesh(0.4, 4), 150, 2, 0.05, 1);
  expect_same_on_a_walk(ball_mesh(0.5, 5), ball_mesh(1, 9), 150, 3, 0.05, 2);
  expect_same_on_a_walk(random_soup(4, 20, 1, 0.9), random_soup(5, 20, 1, 0.5), 150, 5, 0.3, 3);
  expect_same_on_a_walk(one_triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}), ball_mesh(0.3, 3), 60, 1, 0.1, 4);
}
TEST(DistanceState, ChangesNoBitWithOptions) {
  const Mesh a = random_soup(6, 200, 1, 0.2), b = ball_mesh(0.4, 4);
  expect_same_on_a_walk(a, b, 40, 2, 0.05, 5, {.tolerance = 0.1});
  expect_same_on_a_walk(a, b, 40, 2, 0.05, 6, {.limit = 0.5});
  expect_same_on_a_walk(a, b, 40, 2, 0.05, 7, {.max_steps = 40});
}

// Surfaces of which very many pairs are about equally near, or whose boxes prove a distance.
TEST(DistanceState, ChangesNoBitOfConformingSurfaces) {
  expect_same_on_a_walk(ball_mesh(1, 20), ball_mesh(0.95, 20), kSanitized ? 5 : 20, 0.01, 0.001, 8);
  expect_same_on_a_walk(cube_mesh(12), cube_mesh(16), 40, 3, 0.1, 9);
  const Pair cubes(cube_mesh(40), cube_mesh(30));
  Random random(10);
  DistanceState followed;
  for (int n = 0; n < (kSanitized ? 12 : 60); ++n) {  // faces that are parallel, or nearly so
    const double tilt = n % 4 == 0 ? 0 : std::pow(10, random.between(-16, -3));
    const Pose pose = make_pose({1, 0.3, 0}, tilt, {0.1 * random.between(-1, 1), 0, 1 + std::pow(10, n % 9 - 8.0)});
    expect_same_with_any_state(cubes, {}, pose, random, followed);
  }
}

// All pairs are equally near: which one is reported is decided by the order of the triangles, or by a proof.
TEST(DistanceState, ChangesNoBitOfCopies) {
  for (const std::size_t count : {30, 60, 70, 200}) {
    Mesh copies{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {}};
    copies.triangles.assign(count, {0, 1, 2});
    expect_same_on_a_walk(copies, copies, 20, 2, 0.1, 11);
    expect_same_on_a_walk(copies, one_triangle({0, 0, 0}, {1, 0.1, 0}, {0, 1, 0.2}), 20, 2, 0.1, 12);
  }
}

TEST(DistanceState, FromOtherBodiesIsValid) {
  const Pair large(ball_mesh(1, 9), ball_mesh(0.5, 9)), small(ball_mesh(1, 2), ball_mesh(0.5, 2));
  DistanceState state;
  distance(large.a, {}, large.b, moved({-2, -2, -2}), {}, state);
  const Pose pose = moved({2, 1, 0.5});
  const DistanceResult expected = distance(small.a, {}, small.b, pose);
  expect_same(distance(small.a, {}, small.b, pose, {}, state), expected);
  EXPECT_EQ(state.distance, expected.upper);
  const DistanceState end{kNoTriangle, kNoTriangle, kInfinity};
  state = end;
  expect_same(distance(small.b, pose, small.a, {}, {}, state), distance(small.b, pose, small.a, {}));
}

// A batch passes states on.
TEST(DistanceState, OfABatchChangesNoBit) {
  const Pair pair(random_soup(3, 300, 1, 0.2), ball_mesh(0.4, 6));
  std::vector<Pose> poses;
  for (int n = 0; n < 200; ++n)
    poses.push_back(make_pose({1, 2, 3}, 0.02 * n, {1.5 * std::cos(0.01 * n), 0.01 * n, 0}));
  for (const int threads : {1, 3}) {
    const auto found = distance_all(pair.a, {}, pair.b, poses, {}, {.threads = threads}).results;
    for (std::size_t n = 0; n < poses.size(); ++n) expect_same(found[n], distance(pair.a, {}, pair.b, poses[n]));
  }
}

}  // namespace
}  // namespace standoff
