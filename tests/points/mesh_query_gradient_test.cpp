// SPDX-License-Identifier: Apache-2.0
// Gradients of a MeshQuery against difference quotients and normals.
#include <gtest/gtest.h>

#include "scenes/scenes.h"
#include "standoff/points.h"
#include "tests/sign/shapes.h"
#include "tests/support/expect_error.h"

namespace standoff::testing {
namespace {

std::vector<ClosestPoint> ask(const MeshQuery& query, std::span<const Vec3> points) {
  std::vector<ClosestPoint> found(points.size());
  query.closest(points, found);
  return found;
}

double distance(const MeshQuery& query, Vec3 p) {
  double found = 0;
  query.distances({&p, 1}, {&found, 1});
  return found;
}

Vec3 gradient(const MeshQuery& query, Vec3 p) { return query.gradient(p, ask(query, {&p, 1})[0]); }

MeshQuery query_by(const Mesh& mesh, SignMethod method, bool invert = false, double shell = 0) {
  return MeshQuery(mesh, {.sign = {.method = method, .invert = invert, .shell = shell}});
}

Vec3 normal_of(const Mesh& mesh, std::uint32_t t) {
  const auto [a, b, c] = MeshView(mesh).corners(t);
  const Vec3 n = cross(b - a, c - a);
  return n * (1 / length(n));
}

void expect_near(Vec3 found, Vec3 expected, double error) {
  EXPECT_LE(max_norm(found - expected), error) << found.x << ' ' << found.y << ' ' << found.z << " is not "
                                               << expected.x << ' ' << expected.y << ' ' << expected.z;
}

// Compares away from creases, where the quotients of both sides agree.
void expect_slopes(const MeshQuery& query, double reach, unsigned seed) {
  constexpr double kStep = 1e-5;
  Random random(seed);
  int compared = 0;
  for (int n = 0; n < 400; ++n) {
    const Vec3 p = random.in_cube(reach), at = gradient(query, p);
    EXPECT_NEAR(length(at), 1, 1e-14);
    const double middle = distance(query, p);
    if (std::abs(middle) < 3 * kStep) continue;
    Vec3 before, after;
    for (double Vec3::*axis : {&Vec3::x, &Vec3::y, &Vec3::z}) {
      Vec3 low = p, high = p;
      low.*axis -= kStep;
      high.*axis += kStep;
      before.*axis = (middle - distance(query, low)) / kStep;
      after.*axis = (distance(query, high) - middle) / kStep;
    }
    if (max_norm(after - before) > 1e-3) continue;
    ++compared;
    expect_near(at, (before + after) * 0.5, 2e-3);
  }
  EXPECT_GT(compared, 200);
}

TEST(MeshQueryGradient, IsTheSlopeOfTheDistance) {
  const Mesh solid = joined(box({-2, -2, -2}, {0.5, 1, 1}), box({-0.3, -0.2, -0.1}, {2, 2, 2}));
  for (const SignMethod method : {SignMethod::none, SignMethod::winding, SignMethod::parity})
    expect_slopes(query_by(solid, method), 3, 1);
  expect_slopes(query_by(solid, SignMethod::winding, true), 3, 2);
  expect_slopes(query_by(torus(), SignMethod::normal), 1.5, 3);
  expect_slopes(query_by(terrain(), SignMethod::none), 1.5, 4);
}

// Beyond half of the thickness a shell's distance is positive, and it grows away from the sheet.
TEST(MeshQueryGradient, OfAShell) {
  const Mesh sheet{{{-9, -9, 0}, {9, -9, 0}, {0, 18, 0}}, {{0, 1, 2}}};
  for (const double z : {2.0, 0.3, -0.3, -2.0}) {
    SCOPED_TRACE(z);
    const Vec3 away{0, 0, z < 0 ? -1.0 : 1.0};
    expect_near(gradient(query_by(sheet, SignMethod::shell, false, 1), {0.5, 0.25, z}), away, 1e-14);
    expect_near(gradient(query_by(sheet, SignMethod::shell, true, 1), {0.5, 0.25, z}), away * -1.0, 1e-14);
  }
}

TEST(MeshQueryGradient, OnTheSurfaceIsTheOutwardNormal) {
  const Mesh sphere = box({0, 0, 0}, {4, 4, 4}), turned = reversed(sphere);
  std::vector<Vec3> points;
  for (const double u : {0.0, 1.0, 4.0})
    for (const double v : {0.0, 2.0, 3.0})
      points.insert(points.end(), {{u, v, 0}, {u, v, 4}, {u, 0, v}, {u, 4, v}, {0, u, v}, {4, u, v}});
  const auto expect_normals = [&](const MeshQuery& query, const Mesh& outward, double sign) {
    const std::vector<ClosestPoint> found = ask(query, points);
    for (std::size_t n = 0; n < points.size(); ++n) {
      SCOPED_TRACE(::testing::Message() << points[n].x << ' ' << points[n].y << ' ' << points[n].z);
      if (found[n].distance != 0) continue;
      expect_near(query.gradient(points[n], found[n]), normal_of(outward, found[n].triangle) * sign, 1e-7);
    }
    EXPECT_GT(std::ranges::count(found, 0.0, &ClosestPoint::distance), 30);
  };
  for (const SignMethod method : {SignMethod::winding, SignMethod::normal, SignMethod::automatic}) {
    expect_normals(query_by(sphere, method), sphere, 1);
    expect_normals(query_by(turned, method), sphere, 1);  // repaired
    expect_normals(query_by(sphere, method, true), sphere, -1);
  }
}

// Points of tilted faces are off them by rounding, which gives no direction.
TEST(MeshQueryGradient, OnTiltedFacesIsTheOutwardNormalToo) {
  for (const double far : {0.0, 1000.0}) {
    const Mesh mesh = moved(scenes::make("sphere", 100), {far, -far, far});
    const MeshQuery query = query_by(mesh, SignMethod::winding);
    Random random(5);
    for (int n = 0; n < 2000; ++n) {
      const auto t = random.below(static_cast<std::uint32_t>(mesh.triangles.size()));
      const auto [a, b, c] = MeshView(mesh).corners(t);
      const double u = random.between(0.1, 0.5), v = random.between(0.1, 0.4);
      const Vec3 p = a + (b - a) * u + (c - a) * v;
      expect_near(gradient(query, p), normal_of(mesh, t), 1e-9);
    }
  }
}

TEST(MeshQueryGradient, OfTrianglesWithoutAreaIsAUnitVectorToo) {
  const Mesh mesh{{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {5, 5, 5}}, {{0, 1, 2}, {3, 3, 3}, {0, 0, 1}}};
  for (const double size : {1e-100, 1e-9, 1.0, 1e100}) {
    const Mesh scaled = moved(mesh, {}, size);
    const MeshQuery query(scaled, {.sign = {SignMethod::none}});
    for (const Vec3& at : {Vec3{0, 0, 0}, {1, 0, 0}, {0.5, 0, 0}, {5, 5, 5}, {5, 5, 6}, {0.3, 1, 0}}) {
      const Vec3 found = gradient(query, at * size);
      EXPECT_NEAR(length(found), 1, 1e-6) << at.x << ' ' << at.y << ' ' << at.z << " times " << size;
    }
  }
  EXPECT_NEAR(length(gradient(MeshQuery(mesh, {.sign = {SignMethod::none}}), {1e150, -1e150, 3})), 1, 1e-14);
}

TEST(MeshQueryGradient, WantsATriangleOfTheMesh) {
  const MeshQuery query(box(), {.sign = {SignMethod::none}});
  ClosestPoint at{.triangle = 11};
  EXPECT_NO_THROW(query.gradient({}, at));
  at.triangle = 12;
  expect_error([&] { query.gradient({}, at); }, ErrorCode::usage, "12");
  expect_error([&] { query.gradient({}, {}); }, ErrorCode::usage, "triangle");
}

}  // namespace
}  // namespace standoff::testing
