// SPDX-License-Identifier: Apache-2.0
// Queries at points by the GPU's kernel, emulated: the CPU's answers, bit by bit.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>

#include "gpu/emulation/block.h"
#include "points/device.h"
#include "scenes/scenes.h"
#include "standoff/error.h"
#include "standoff/points.h"
#include "standoff/testing/emulation.h"
#include "tests/support/changed_mesh.h"
#include "tests/support/error_code.h"
#include "tests/support/random_mesh.h"

namespace standoff {
namespace {

using namespace standoff::testing;

const Execution kEmulation{.threads = 2, .backend = testing::kEmulated};
constexpr Execution kCpu{.threads = 2, .backend = Backend::cpu};

bool same_bits(double a, double b) { return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b); }

// Points around the mesh, on its surface, at its corners, and far away.
std::vector<Vec3> points_for(const Mesh& mesh, int count) {
  Random random(17);
  const Box box = bounds(mesh);
  const Vec3 reach = box.extent() + Vec3{1, 1, 1} * (0.01 * length(box.extent()));
  std::vector<Vec3> points;
  for (int n = 0; n < count; ++n) {
    const Vec3 anywhere = box.center() + reach * random.in_cube(1);
    const Triangle& t = mesh.triangles[random.below(static_cast<std::uint32_t>(mesh.triangles.size()))];
    const Vec3 a = mesh.vertices[t[0]], b = mesh.vertices[t[1]], c = mesh.vertices[t[2]];
    const double u = random.between(0, 1), v = random.between(0, 1 - u);
    const Vec3 on = a + (b - a) * u + (c - a) * v;
    const Vec3 choices[] = {anywhere,       on, a, (a + b) * 0.5, on + reach * random.in_cube(1e-6), anywhere * 1e3,
                            anywhere * 1e40};
    const double most = max_norm(choices[n % 7]);
    points.push_back(choices[n % 7] * (most > kMaxCoordinate ? 0.5 * kMaxCoordinate / most : 1));
  }
  return points;
}

void expect_as_cpu(const Mesh& mesh, const SignOptions& sign = {}, int count = 400) {
  const MeshQuery query(mesh, {.sign = sign});
  const std::vector<Vec3> points = points_for(mesh, count);
  std::vector<ClosestPoint> expected(points.size()), found(points.size());
  std::vector<double> distances(points.size());
  query.closest(points, expected, {.execution = kCpu});
  query.closest(points, found, {.execution = kEmulation});
  query.distances(points, distances, {.execution = kEmulation});
  int different = 0;
  for (std::size_t n = 0; n < points.size(); ++n) {
    const ClosestPoint &a = expected[n], &b = found[n];
    different += !same_bits(a.distance, b.distance) || !same_bits(a.distance, distances[n]) ||
                 a.triangle != b.triangle || !(a.point == b.point) || a.feature != b.feature;
  }
  EXPECT_EQ(different, 0);
}

// Needles and blades: their width is lost in rounding.
Mesh slivers() {
  Random random(23);
  Mesh mesh;
  for (int n = 0; n < 200; ++n) {
    const Vec3 a = random.in_cube(1), b = random.in_cube(1);
    add_triangle(mesh, a, b,
                 a + (b - a) * random.between(0, 1) + random.in_cube(1) * std::pow(10, -random.between(5, 17)));
  }
  return mesh;
}

TEST(CudaPoints, AllKindsOfTriangles) {
  expect_as_cpu(random_soup(1, 1, 1, 1));
  expect_as_cpu(random_soup(2, 3, 1, 1));
  expect_as_cpu(random_soup(3, 5, 1, 0.2));
  expect_as_cpu(random_soup(4, 1000, 1, 0.05));
  expect_as_cpu(random_soup(5, 300, 0.1, 2));
  expect_as_cpu(crowd(6, 500));
  for (const unsigned seed : {7u, 8u, 9u}) expect_as_cpu(nasty_soup(seed, 60, 2));
  expect_as_cpu(slivers());
}

TEST(CudaPoints, AllPlacesAndSizes) {
  const Mesh soup = random_soup(10, 200, 1, 0.2);
  for (const double scale : {1e-150, 1e-30, 1e-6, 1e6, 1e60, 1e149}) expect_as_cpu(moved(soup, {}, scale));
  for (const double far : {1e3, 1e9, 1e14}) expect_as_cpu(moved(soup, {far, -far / 3, far / 7}));
  expect_as_cpu(moved(soup, {1, 2, 3}, 0));  // one point
  Mesh flat = soup;
  for (Vec3& v : flat.vertices) v.z = 0;
  expect_as_cpu(flat);
}

TEST(CudaPoints, Signs) {
  expect_as_cpu(scenes::make("box"), {.method = SignMethod::winding});
  expect_as_cpu(scenes::make("fly", 2000), {.method = SignMethod::automatic});
  expect_as_cpu(scenes::make("box"), {.method = SignMethod::shell, .shell = 0.3});
  expect_as_cpu(random_soup(11, 100, 1, 0.5), {.method = SignMethod::winding});
}

TEST(CudaPoints, EveryOrderOfThreads) {
  for (const emulation::Order order : {emulation::Order::reverse, emulation::Order::random}) {
    const emulation::OrderScope scope(order);
    expect_as_cpu(nasty_soup(12, 40, 2), {}, 100);
  }
}

TEST(CudaPoints, TheTreeIsBuiltOnceAndCopiesShareIt) {
  const MeshQuery query(random_soup(13, 50, 1, 0.2), {.sign = {SignMethod::none}}), copy = query;
  const std::vector<Vec3> points(3, Vec3{1, 2, 3});
  std::vector<double> first(3), second(3), none;
  const std::int64_t launches = emulation::launch_count();
  query.distances(points, first, {.execution = kEmulation});
  copy.distances(points, second, {.execution = kEmulation});
  EXPECT_EQ(emulation::launch_count(), launches + 2);
  EXPECT_EQ(first, second);
  query.distances({}, none, {.execution = kEmulation});
}

TEST(CudaPoints, Errors) {
  const MeshQuery query(random_soup(14, 5, 1, 0.2), {.sign = {SignMethod::none}});
  std::vector<double> out(1);
  const auto ask = [&](Vec3 point, const Execution& execution) {
    return code_of([&] { query.distances(std::vector<Vec3>{point}, out, {.execution = execution}); });
  };
  EXPECT_EQ(ask({0, NAN, 0}, kEmulation), ErrorCode::usage);
  EXPECT_EQ(ask({0, 1e151, 0}, kEmulation), ErrorCode::limit);
  if (!find_point_device(Backend::automatic, 1'000'000)) {
    EXPECT_EQ(ask({0, 0, 0}, {.backend = Backend::cuda}), ErrorCode::device);
  }
  EXPECT_EQ(find_point_device(Backend::automatic, 10), nullptr);
  EXPECT_EQ(find_point_device(Backend::cpu, 1'000'000), nullptr);
}

}  // namespace
}  // namespace standoff
