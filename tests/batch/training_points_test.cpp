// SPDX-License-Identifier: Apache-2.0
#include "batch/training_points.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "scenes/scenes.h"
#include "tests/support/error_code.h"

namespace standoff::testing {
namespace {

const Box kBox{{-2, -2, -2}, {2, 2, 2}};

TrainingPoints points_of(const Mesh& mesh, const TrainingPointOptions& options, int threads = 0) {
  return training_points(MeshQuery(mesh), kBox, options, threads);
}

Vec3 at(const TrainingPoints& made, std::size_t n) { return {made.points[n][0], made.points[n][1], made.points[n][2]}; }

// Of the points as they are stored, not as they were drawn.
TEST(TrainingPoints, DistancesAreExact) {
  const MeshQuery query(scenes::make("sphere", 2000));
  const TrainingPoints made = training_points(query, kBox, {.count = 3000});
  std::vector<Vec3> points;
  for (std::size_t n = 0; n < made.points.size(); ++n) points.push_back(at(made, n));
  std::vector<double> distances(points.size());
  query.distances(points, distances);
  for (std::size_t n = 0; n < points.size(); ++n) EXPECT_EQ(made.distances[n], static_cast<float>(distances[n])) << n;
}

// A box of sides 2, 1.5 and 1: the distances from its faces tell the offsets.
TEST(TrainingPoints, TheirShares) {
  const Mesh box = scenes::make("box");
  const TrainingPoints made = points_of(box, {.count = 40'000, .near_share = 0.75, .sigma = {0.01, 0.001}});
  ASSERT_EQ(made.points.size(), 40'000u);
  double squares[2] = {0, 0}, most = 0;
  for (std::size_t n = 0; n < 30'000; ++n) {
    squares[n % 2] += made.distances[n] * made.distances[n];
    most = std::max<double>(most, std::abs(made.distances[n]));
  }
  // Next to a face, the distance is the offset along its normal: 4 is the longest side of kBox.
  EXPECT_NEAR(std::sqrt(squares[0] / 15'000), 0.04, 0.002);
  EXPECT_NEAR(std::sqrt(squares[1] / 15'000), 0.004, 0.0002);
  EXPECT_LE(most, 6 * 0.04 * std::sqrt(3));
  // Each face as often as it is large, of 13 in all: those at x = +1 and -1 have 1.5 each.
  const auto face = [&](double side) {
    return std::ranges::count_if(made.points.begin(), made.points.begin() + 30'000, [&](const std::array<float, 3>& p) {
      return std::abs(p[0] - side) < 0.02 && std::abs(p[1]) < 0.7 && std::abs(p[2]) < 0.45;
    });
  };
  EXPECT_NEAR(static_cast<double>(face(1)), static_cast<double>(face(-1)), 300);
  // The others fill the box: an eighth in each corner of it.
  int corners[8] = {};
  for (std::size_t n = 30'000; n < 40'000; ++n) {
    const Vec3 p = at(made, n);
    ++corners[(p.x > 0) + 2 * (p.y > 0) + 4 * (p.z > 0)];
    EXPECT_TRUE(p.x >= -2 && p.x <= 2 && p.y >= -2 && p.y <= 2 && p.z >= -2 && p.z <= 2);
  }
  for (const int count : corners) EXPECT_NEAR(count, 1250, 150);
}

TEST(TrainingPoints, DependOnMeshBoxAndOptionsAlone) {
  const Mesh mesh = scenes::make("fly", 3000);
  const TrainingPoints made = points_of(mesh, {.count = 1000});
  EXPECT_EQ(points_of(mesh, {.count = 1000}, 1).points, made.points);
  EXPECT_EQ(points_of(mesh, {.count = 1000}, 3).distances, made.distances);
  EXPECT_NE(points_of(mesh, {.count = 1000, .seed = 1}).points, made.points);
  Mesh moved = mesh;
  moved.vertices[0].x += 1e-12;
  EXPECT_NE(points_of(moved, {.count = 1000}).points, made.points);
  // Fewer near points are the first of more.
  const TrainingPoints fewer = points_of(mesh, {.count = 100, .near_share = 1});
  EXPECT_TRUE(std::equal(fewer.points.begin(), fewer.points.end(), made.points.begin()));
}

// The same numbers on every machine and in every version: training goes on elsewhere.
TEST(TrainingPoints, StayWhatTheyAre) {
  const TrainingPoints made = points_of(scenes::make("box"), {.count = 2, .near_share = 0.5, .seed = 7});
  const std::array<float, 3> near{0x1.515076p-1f, -0x1.8fdde8p-1f, -0x1.85d494p-3f},
      uniform{-0x1.fb4882p+0f, -0x1.7ebc8ap+0f, 0x1.11b73cp+0f};
  EXPECT_EQ(made.points[0], near);
  EXPECT_EQ(made.points[1], uniform);
}

TEST(TrainingPoints, AllNearOrNone) {
  const Mesh box = scenes::make("box");
  for (const float distance : points_of(box, {.count = 500, .near_share = 1, .sigma = {0, 0}}).distances)
    EXPECT_NEAR(distance, 0, 1e-7);
  EXPECT_EQ(points_of(box, {.count = 500, .near_share = 0}).points.size(), 500u);
}

TEST(TrainingPoints, RefuseWhatMakesNoSense) {
  const Mesh box = scenes::make("box");
  for (const TrainingPointOptions& options :
       {TrainingPointOptions{.count = 0}, TrainingPointOptions{.count = 5, .near_share = 1.5},
        TrainingPointOptions{.count = 5, .near_share = NAN}, TrainingPointOptions{.count = 5, .sigma = {-1, 0}},
        TrainingPointOptions{.count = 5, .sigma = {0, INFINITY}}})
    EXPECT_EQ(code_of([&] { points_of(box, options); }), ErrorCode::usage);
  const Mesh line{{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}}};
  EXPECT_EQ(code_of([&] { points_of(line, {.count = 5}); }), ErrorCode::input);
  EXPECT_EQ(points_of(line, {.count = 5, .near_share = 0}).distances.size(), 5u);
}

}  // namespace
}  // namespace standoff::testing
