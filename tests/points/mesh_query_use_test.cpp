// SPDX-License-Identifier: Apache-2.0
// A MeshQuery's errors, cancellation, and copies.
#include <gtest/gtest.h>

#include <optional>
#include <stdexcept>

#include "scenes/scenes.h"
#include "standoff/points.h"
#include "tests/sign/shapes.h"
#include "tests/support/expect_error.h"

namespace standoff::testing {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinite = std::numeric_limits<double>::infinity();

// Asks all three questions about the same points.
template <class Check>
void for_each_question(const MeshQuery& query, std::span<const Vec3> points, std::size_t answers,
                       const Execution& execution, const ProgressCallback& progress, const Check& check) {
  std::vector<double> numbers(answers);
  std::vector<ClosestPoint> closest(answers);
  check([&] { query.distances(points, numbers, {.execution = execution, .progress = progress}); });
  check([&] { query.closest(points, closest, {.execution = execution, .progress = progress}); });
  check([&] { query.winding_numbers(points, numbers, {.execution = execution, .progress = progress}); });
}

MeshQuery signed_query(const Mesh& mesh) { return MeshQuery(mesh, {.sign = {.method = SignMethod::winding}}); }

TEST(MeshQueryUse, PointsThatCannotBe) {
  const MeshQuery query = signed_query(box());
  const auto expect = [&](Vec3 bad, ErrorCode code, const char* words) {
    std::vector<Vec3> points(9);
    points[7] = bad;
    for_each_question(query, points, 9, {}, {}, [&](auto call) {
      expect_error(call, code, words);
      expect_error(call, code, "point 7");
    });
  };
  for (const double x : {kNaN, kInfinite, -kInfinite}) {
    expect({x, 0, 0}, ErrorCode::usage, "not finite");
    expect({0, x, 0}, ErrorCode::usage, "not finite");
    expect({0, 0, x}, ErrorCode::usage, "not finite");
  }
  for (const double x : {1.01e150, -1e300}) expect({0, x, 0}, ErrorCode::limit, "beyond");
}

TEST(MeshQueryUse, AsManyAnswersAsPoints) {
  const MeshQuery query = signed_query(box());
  const std::vector<Vec3> points(3);
  for (const std::size_t answers : {0, 2, 4})
    for_each_question(query, points, answers, {}, {},
                      [&](auto call) { expect_error(call, ErrorCode::usage, "as many"); });
  for_each_question(query, {}, 0, {}, {}, [](auto call) { EXPECT_NO_THROW(call()); });
}

TEST(MeshQueryUse, Executions) {
  const Mesh mesh = box();
  const MeshQuery query = signed_query(mesh);
  const std::vector<Vec3> points(3);
  for (const Execution& execution :
       {Execution{.threads = -1}, {.threads = 1025}, {.device = -1}, {.simd = static_cast<Simd>(9)}}) {
    for_each_question(query, points, 3, execution, {},
                      [](auto call) { expect_error(call, ErrorCode::usage, "points"); });
    expect_error([&] { MeshQuery(mesh, {.sign = {SignMethod::none}, .execution = execution}); }, ErrorCode::usage,
                 "points");
  }
}

TEST(MeshQueryUse, Meshes) {
  Mesh out_of_range = box(), not_finite = box(), beyond = box();
  out_of_range.triangles[3][1] = 8;
  not_finite.vertices[4].y = kNaN;
  beyond.vertices[4].y = 2e150;
  expect_error([&] { MeshQuery(Mesh{}, {.sign = {SignMethod::none}}); }, ErrorCode::input, "triangle");
  expect_error([&] { MeshQuery{out_of_range}; }, ErrorCode::input, "triangle 3");
  expect_error([&] { MeshQuery{not_finite}; }, ErrorCode::input, "finite");
  expect_error([&] { MeshQuery{beyond}; }, ErrorCode::limit, "beyond");
  expect_error([&] { MeshQuery(box(), {.sign = {.method = static_cast<SignMethod>(77)}}); }, ErrorCode::usage, "sign");
}

TEST(MeshQueryUse, IsCancelledByItsProgress) {
  const MeshQuery query = signed_query(box());
  std::vector<Vec3> points(20000);
  Random random(1);
  for (Vec3& p : points) p = random.in_cube(2);
  for_each_question(
      query, points, points.size(), {}, [](const Progress&) { return false; },
      [](auto call) { expect_error(call, ErrorCode::interrupted, ""); });
  for_each_question(
      query, points, points.size(), {}, [](const Progress&) -> bool { throw std::domain_error("of the caller"); },
      [](auto call) { EXPECT_THROW(call(), std::domain_error); });
  double last = -1;
  for_each_question(
      query, points, points.size(), {},
      [&](const Progress& progress) {
        EXPECT_GE(progress.fraction, last);
        EXPECT_LE(progress.fraction, 1);
        last = progress.fraction;
        return true;
      },
      [&](auto call) {
        last = -1;
        EXPECT_NO_THROW(call());
        EXPECT_GE(last, 0);
      });
}

TEST(MeshQueryUse, CopiesShareAndOutliveTheOriginal) {
  std::optional<Mesh> mesh = scenes::make("sphere", 300);
  std::optional<MeshQuery> query = signed_query(*mesh);
  const std::vector<Vec3> points{{0, 0, 0}, {0, 0, 3}, {0.5, 0.25, 0}};
  std::vector<double> before(3), after(3);
  query->distances(points, before);
  const MeshQuery copy = *query;
  EXPECT_EQ(copy.mesh().vertices.size(), mesh->vertices.size());
  EXPECT_EQ(copy.memory_bytes(), query->memory_bytes());
  const MeshQuery moved = std::move(*query);
  query->distances(points, after);  // NOLINT(bugprone-use-after-move): moves copy
  EXPECT_EQ(before, after);
  query.reset();
  mesh.reset();
  copy.distances(points, after);
  EXPECT_EQ(before, after);
  EXPECT_LT(before[0], 0);
  moved.distances(points, after);
  EXPECT_EQ(before, after);
  EXPECT_EQ(copy.sign().method, SignMethod::winding);
}

TEST(MeshQueryUse, ManyThreadsAskAtOnce) {
  const MeshQuery query = signed_query(scenes::make("sphere", 300));
  std::vector<Vec3> points(500);
  Random random(2);
  for (Vec3& p : points) p = random.in_cube(2);
  std::vector<double> expected(points.size());
  query.distances(points, expected);
  std::vector<std::vector<double>> found(4, std::vector<double>(points.size()));
  std::vector<std::thread> threads;
  for (std::vector<double>& own : found) threads.emplace_back([&] { query.distances(points, own); });
  for (std::thread& thread : threads) thread.join();
  for (const std::vector<double>& own : found) EXPECT_EQ(own, expected);
}

// It takes the mesh, and some 170 bytes per triangle.
TEST(MeshQueryUse, SaysWhatItTakes) {
  const Mesh mesh = scenes::make("sphere", 20000);
  const double triangles = static_cast<double>(mesh.triangles.size());
  const double of_mesh = static_cast<double>(mesh.vertices.size() * sizeof(Vec3)) + triangles * sizeof(Triangle);
  const double more = static_cast<double>(MeshQuery(mesh, {.sign = {SignMethod::none}}).memory_bytes()) - of_mesh;
  EXPECT_GT(more, 100 * triangles);
  EXPECT_LT(more, 200 * triangles);
}

}  // namespace
}  // namespace standoff::testing
