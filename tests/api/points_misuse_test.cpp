// SPDX-License-Identifier: Apache-2.0
// points.h with arguments that make no sense.
#include "standoff/points.h"

#include "tests/api/misuse.h"

namespace standoff {
namespace {

using namespace testing;

const std::array kMethods{SignMethod::none,  SignMethod::winding, SignMethod::parity,    SignMethod::normal,
                          SignMethod::flood, SignMethod::shell,   SignMethod::automatic, none_of<SignMethod>()};

// Every question about some points.
void ask_all(const std::string& name, const MeshQuery& query, std::span<const Vec3> points) {
  std::vector<double> numbers(points.size());
  std::vector<ClosestPoint> closest(points.size());
  expect_answer_or_error(name, [&] { query.distances(points, numbers); });
  expect_answer_or_error(name, [&] { query.closest(points, closest); });
  expect_answer_or_error(name, [&] { query.winding_numbers(points, numbers); });
  for (const ClosestPoint& at : closest)
    expect_answer_or_error(name, [&] { EXPECT_FALSE(std::isnan(query.gradient(points[0], at).x)); });
  EXPECT_GT(query.memory_bytes(), 0) << name;
  EXPECT_NE(query.sign().method, SignMethod::automatic) << name;
  EXPECT_FALSE(query.mesh().triangles.empty()) << name;
}

TEST(PointsMisuse, Meshes) {
  const std::vector<Vec3> points{{}, {1e-300, 1, 1}, {1e150, -1e150, 0}};
  for (const Mesh& mesh : odd_meshes())
    for (const SignMethod method : kMethods)
      for (const bool outer : {false, true})
        expect_answer_or_error(named("method", static_cast<int>(method)), [&] {
          const SignOptions sign{.method = method, .outer = outer, .shell = method == SignMethod::shell ? 0.1 : 0};
          ask_all("odd mesh", MeshQuery(mesh, {.sign = sign}), points);
        });
}

TEST(PointsMisuse, Signs) {
  for (const double shell : kNumbers)
    expect_answer_or_error(named("shell", shell), [&] {
      const SignOptions sign{.method = SignMethod::shell, .shell = shell};
      ask_all("shell", MeshQuery(one_triangle(), {.sign = sign}), std::vector<Vec3>(2));
    });
  const SignOptions rule{.method = SignMethod::winding, .rule = none_of<WindingRule>()};
  expect_usage("rule", [&] { MeshQuery(one_triangle(), {.sign = rule}); });
  expect_usage("flood", [&] { MeshQuery(one_triangle(), {.sign = {.method = SignMethod::flood}}); });
}

TEST(PointsMisuse, Points) {
  const MeshQuery query(one_triangle(), {.sign = {.method = SignMethod::winding}});
  for (const double x : kNumbers) ask_all(named("point", x), query, std::vector<Vec3>{{0, x, 0}, {x, x, x}});
  std::vector<double> few(1);
  std::vector<ClosestPoint> few_closest(1);
  const std::vector<Vec3> points(3);
  expect_usage("few", [&] { query.distances(points, few); });
  expect_usage("few", [&] { query.closest(points, few_closest); });
  expect_usage("few", [&] { query.winding_numbers(points, few); });
  for (const int threads : kThreads) {
    expect_usage("threads",
                 [&] { MeshQuery(one_triangle(), {.sign = {SignMethod::none}, .execution = {.threads = threads}}); });
    expect_usage("threads", [&] { query.distances({points.data(), 1}, few, {.execution = {.threads = threads}}); });
    expect_usage("threads", [&] {
      query.closest({points.data(), 1}, few_closest, {.execution = {.threads = threads}});
    });
    expect_usage("threads", [&] {
      query.winding_numbers({points.data(), 1}, few, {.execution = {.threads = threads}});
    });
  }
}

TEST(PointsMisuse, Gradients) {
  const MeshQuery query(one_triangle(), {.sign = {SignMethod::none}});
  for (const double x : kNumbers)
    for (const double y : kNumbers) {
      ClosestPoint at{.distance = y, .point = {y, 0, y}, .triangle = 0};
      expect_answer_or_error(named("gradient", x), [&] { query.gradient({x, 0, 0}, at); });
    }
  for (const std::uint32_t triangle : {1u, kNoTriangle}) {
    ClosestPoint at{.triangle = triangle};
    expect_usage("triangle", [&] { query.gradient({}, at); });
  }
}

}  // namespace
}  // namespace standoff
