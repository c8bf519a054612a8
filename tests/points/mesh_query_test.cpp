// SPDX-License-Identifier: Apache-2.0
// Compares distances and closest points of a MeshQuery with all triangles: bit by bit by the same measure, and within
// rounding by another one.
#include <gtest/gtest.h>

#include <bit>

#include "geometry/triangle_distance.h"
#include "scenes/scenes.h"
#include "simd/dispatch.h"
#include "standoff/points.h"
#include "tests/support/changed_mesh.h"
#include "tests/support/random_mesh.h"
#include "tests/support/reference.h"
#include "tests/support/sanitized.h"
#include "tests/support/welded_ball.h"

namespace standoff::testing {
namespace {

// The extent of a point and the box of a mesh together.
double extent_of(const Box& box, Vec3 p) { return std::max(max_norm(box.min - p), max_norm(box.max - p)); }

struct Nearest {
  double distance;
  std::uint32_t triangle;
};

// The nearest of all triangles; the lowest index wins a tie. Lengths are scaled by a power of two to about 1, so that
// their fourth powers neither overflow nor vanish.
Nearest nearest_of_all(const Mesh& mesh, Vec3 p, double extent) {
  const double shrink = extent > 0 ? std::ldexp(1, -std::ilogb(extent)) : 1;
  Nearest best{std::numeric_limits<double>::infinity(), kNoTriangle};
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto corner = [&](int k) { return triple_of((mesh.vertices[mesh.triangles[t][k]] - p) * shrink); };
    const double sq = origin_distance_sq(corner(0), corner(1), corner(2));
    if (sq < best.distance) best = {sq, static_cast<std::uint32_t>(t)};
  }
  return {std::sqrt(best.distance) / shrink, best.triangle};
}

std::vector<ClosestPoint> ask(const MeshQuery& query, std::span<const Vec3> points, const Execution& execution = {}) {
  std::vector<ClosestPoint> found(points.size());
  query.closest(points, found, {.execution = execution});
  return found;
}

// Checks that an answer is consistent: point, feature and weights agree.
void expect_consistent(const Mesh& mesh, Vec3 p, const ClosestPoint& it, double rounding) {
  EXPECT_NEAR(length((it.point - p) * (1 / rounding)), it.distance / rounding, 1);
  Vec3 weighed;
  double sum = 0;
  int zeros = 0;
  for (int k = 0; k < 3; ++k) {
    EXPECT_GE(it.barycentric[k], 0);
    EXPECT_LE(it.barycentric[k], 1);
    sum += it.barycentric[k];
    zeros += it.barycentric[k] == 0;
    weighed = weighed + (mesh.vertices[mesh.triangles[it.triangle][k]] - p) * it.barycentric[k];
  }
  EXPECT_NEAR(sum, 1, 1e-15);
  EXPECT_LE(max_norm(weighed - (it.point - p)), rounding);
  const int feature = static_cast<int>(it.feature), edge = static_cast<int>(Feature::edge0);
  if (it.feature == Feature::face) {
    EXPECT_EQ(zeros, 0);
  } else if (it.feature >= Feature::vertex0) {
    EXPECT_EQ(it.barycentric[feature - static_cast<int>(Feature::vertex0)], 1);
  } else {
    EXPECT_EQ(it.barycentric[(feature - edge + 2) % 3], 0) << "of the corner that the edge does not have";
  }
}

// `share`: the allowed difference of the other measure, as a share of the extent of mesh and point together; `few`: how
// many points it is applied to, as it is slow.
void expect_exact(const Mesh& mesh, std::span<const Vec3> points, double share = 1e-13, std::size_t few = 50) {
  const Box box = bounds(mesh);
  const MeshQuery query(mesh, {.sign = {SignMethod::none}});
  const std::vector<ClosestPoint> found = ask(query, points);
  std::vector<double> distances(points.size(), -1);
  query.distances(points, distances);
  // A sanitizer looks at the query, which has answered all points by now: few are compared there.
  constexpr std::size_t kStep = kSanitized ? 10 : 1;
  for (std::size_t n = 0; n < points.size() && !::testing::Test::HasFailure(); n += kStep) {
    SCOPED_TRACE(::testing::Message() << "point " << n << " of " << points.size() << ": " << points[n].x << ' '
                                      << points[n].y << ' ' << points[n].z);
    const double extent = extent_of(box, points[n]);
    const Nearest expected = nearest_of_all(mesh, points[n], extent);
    ASSERT_EQ(found[n].triangle, expected.triangle) << found[n].distance << " but " << expected.distance;
    EXPECT_EQ(std::bit_cast<std::uint64_t>(found[n].distance), std::bit_cast<std::uint64_t>(expected.distance));
    EXPECT_EQ(distances[n], expected.distance);
    const double rounding = share * (extent + max_norm(points[n]));
    expect_consistent(mesh, points[n], found[n], rounding > 0 ? rounding : 1);
    if (n >= few || rounding > 1e120) continue;  // there the other measure overflows
    EXPECT_NEAR(found[n].distance, reference_distance(mesh, points[n]), rounding);
  }
}

// Points on corners, edges and faces, up to rounding; some points occur twice.
std::vector<Vec3> points_on(const Mesh& mesh) {
  std::vector<Vec3> points;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 a = mesh.vertices[t[0]], b = mesh.vertices[t[1]], c = mesh.vertices[t[2]];
    points.insert(points.end(), {a, a + (b - a) * 0.5, a + (c - b) * 0.25, (a + b + c) * (1.0 / 3), b, a});
  }
  return points;
}

TEST(MeshQuery, OneTriangleAndMeshesWithoutArea) {
  const Mesh triangle{{{0, 0, 0}, {4, 0, 0}, {0, 3, 0}}, {{0, 1, 2}}};
  const Mesh point{{{1, 2, 3}}, {{0, 0, 0}}};
  const Mesh segment{{{-1, 0, 0}, {1, 2, 0}}, {{0, 1, 1}, {0, 0, 1}, {1, 0, 1}}};
  const Mesh flat = [] {
    Mesh soup = random_soup(21, 300, 4, 1);
    for (Vec3& v : soup.vertices) v.z = 2;
    return soup;
  }();
  for (const Mesh& mesh : {triangle, point, segment, flat})
    for (const int count : {1, 3, 64, 65, 3000}) {
      expect_exact(mesh, points_around(1, count, 6));
      expect_exact(mesh, points_on(mesh));
    }
}

TEST(MeshQuery, SoupsOfManySizes) {
  for (const int triangles : {2, 15, 16, 17, 255, 257, 4500})
    for (const double side : {0.05, 1.0, 4.0})
      for (const int count : {1, 3, 64, 65}) {
        SCOPED_TRACE(::testing::Message() << triangles << " triangles of side " << side);
        expect_exact(random_soup(22, triangles, 4, side), points_around(2, count, 5), 1e-13, 10);
      }
}

// Groups of points share candidates.
TEST(MeshQuery, ManyPointsOnFewTriangles) {
  for (const int triangles : {3, 40, 400}) expect_exact(random_soup(23, triangles, 4, 1), points_around(3, 5000, 4.5));
}

// Points are answered one by one.
TEST(MeshQuery, FewPointsOnManyTriangles) {
  for (const double side : {0.03, 0.5})
    expect_exact(random_soup(24, 9000, 4, side), points_around(4, 600, 4.5), 1e-13, 10);
  // Two crowds of points, each with many triangles; and all of them at a single place.
  const Mesh mesh = random_soup(24, 9000, 4, 0.1);
  std::vector<Vec3> points = points_around(5, 80, 0.2, {3, 3, 3});
  std::ranges::copy(points_around(6, 80, 0.2, {-3, -3, -3}), std::back_inserter(points));
  expect_exact(mesh, points, 1e-13, 10);
  expect_exact(mesh, std::vector<Vec3>(70, Vec3{1, 1, 1}), 1e-13, 10);
}

// Groups of sixteen triangles with a wall and a needle at right angles to it. Boxes were once rotated along the needle,
// with a second axis from the wall's normal, made orthogonal to the needle: nothing but rounding was left of it, so the
// axes were askew, and near boxes seemed to be far.
TEST(MeshQuery, NeedlesAcrossWalls) {
  Random random(31);
  Mesh mesh;
  for (int group = 0; group < 64; ++group) {
    const Vec3 at = random.in_cube(40);
    const Vec3 along = random.in_cube(1) * 8.0;
    const Vec3 side = cross(along, random.in_cube(1)), up = cross(side, along) * (1 / length(along));
    add_triangle(mesh, at, at + along * 2.0, at + along);
    for (int n = 0; n < 15; ++n)
      add_triangle(mesh, at, at + side * random.between(0.1, 0.6) + up * random.between(-0.2, 0.2),
                   at + up * random.between(0.1, 0.6));
  }
  expect_exact(mesh, points_around(32, 500, 50), 1e-13, 10);
}

// Corners on a coarse lattice, copies, segments, points: many triangles are equally near.
TEST(MeshQuery, TiesOfTrianglesThatTouchAndCoincide) {
  for (const int triangles : {30, 600}) {
    const Mesh mesh = nasty_soup(25, triangles, 5);
    expect_exact(mesh, points_on(mesh));
    std::vector<Vec3> points;
    for (int k = -7; k <= 7; ++k)
      for (int j = -7; j <= 7; ++j)
        for (int i = -7; i <= 7; ++i) points.push_back({i * 1.0, j * 1.0, k * 1.0});
    expect_exact(mesh, points);
    // In the reverse order, other triangles win ties.
    Mesh reversed = mesh;
    std::ranges::reverse(reversed.triangles);
    expect_exact(reversed, points, 1e-13, 10);
  }
}

TEST(MeshQuery, Scenes) {
  for (const scenes::Scene& scene : scenes::all()) {
    SCOPED_TRACE(scene.name);
    const Mesh mesh = scenes::make(scene.name, 300);
    if (mesh.triangles.size() > 20000) continue;  // this scene has no small version
    const Box box = bounds(mesh);
    const double reach = std::max(box.longest_side(), 1e-3 * max_norm(box.max - box.min));
    // A sliver's own width is not seen by the measure: see geometry/closest_point_test.cpp.
    expect_exact(mesh, points_around(7, 300, reach, box.min + (box.max - box.min) * 0.5), 1e-8, 20);
    std::vector<Vec3> on = points_on(mesh);
    on.resize(std::min<std::size_t>(on.size(), 200));
    expect_exact(mesh, on, 1e-8, 20);
  }
}

TEST(MeshQuery, FarFromTheOrigin) {
  const Mesh soup = random_soup(26, 300, 4, 1);
  for (const double far : {1e6, 1e12}) {
    const Vec3 at{far, -2 * far, far / 3};
    const Mesh mesh = moved(soup, at);
    expect_exact(mesh, points_around(8, 500, 6, at), 1e-15 * far);
    expect_exact(mesh, points_on(mesh), 1e-15 * far);
  }
}

TEST(MeshQuery, TinyAndHuge) {
  for (const double size : {1e-100, 1e140}) {
    const Mesh mesh = moved(random_soup(27, 300, 4, 1), {}, size);
    std::vector<Vec3> points = points_around(9, 500, 6);
    for (Vec3& p : points) p = p * size;
    expect_exact(mesh, points);
    expect_exact(mesh, points_on(mesh));
  }
}

// Points from just beyond the mesh to coordinates whose squares would overflow without care.
TEST(MeshQuery, PointsFarAway) {
  const Mesh mesh = random_soup(28, 300, 4, 1);
  std::vector<Vec3> points;
  Random random(10);
  // Frames in float give way to double at 1024 half sides.
  for (double far = 4; far < 1e150; far *= far < 2e4 ? 1.05 : 1e6) {
    const Vec3 way = random.in_cube(1);
    points.push_back(way * (far / max_norm(way)));
    points.push_back({far, 0, 0});
  }
  points.push_back({kMaxCoordinate, -kMaxCoordinate, kMaxCoordinate});
  expect_exact(mesh, points);
  // From far away many triangles of a ball are about as near as the nearest.
  expect_exact(welded_ball(4, 20), points);
  for (const double size : {1e-100, 1e-290}) expect_exact(moved(mesh, {}, size), points);
}

void expect_same(std::span<const ClosestPoint> a, std::span<const ClosestPoint> b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t n = 0; n < a.size(); ++n) {
    EXPECT_EQ(std::bit_cast<std::uint64_t>(a[n].distance), std::bit_cast<std::uint64_t>(b[n].distance)) << n;
    EXPECT_EQ(a[n].point, b[n].point) << n;
    EXPECT_EQ(a[n].triangle, b[n].triangle) << n;
    EXPECT_EQ(a[n].feature, b[n].feature) << n;
    EXPECT_EQ(a[n].barycentric, b[n].barycentric) << n;
    if (::testing::Test::HasFailure()) return;
  }
}

TEST(MeshQuery, TheSameBitsForAnyBatchThreadsAndInstructionSet) {
  const Mesh mesh = crowd(29, 2000);
  std::vector<Vec3> points = points_around(11, 9000, 6);
  std::ranges::copy(points_on(mesh), std::back_inserter(points));
  points.push_back({1e9, 0, 0});
  const MeshQuery query(mesh, {.sign = {SignMethod::none}});
  const std::vector<ClosestPoint> once = ask(query, points);
  for (const int threads : {1, 7}) {
    SCOPED_TRACE(threads);
    expect_same(ask(MeshQuery(mesh, {.sign = {SignMethod::none}, .execution = {.threads = threads}}), points,
                    {.threads = threads}),
                once);
  }
  for (const Simd simd : {Simd::portable, Simd::avx2, Simd::avx512}) {
    if (simd != Simd::portable && !processor_has(simd)) continue;
    SCOPED_TRACE(static_cast<int>(simd));
    expect_same(ask(MeshQuery(mesh, {.sign = {SignMethod::none}, .execution = {.simd = simd}}), points, {.simd = simd}),
                once);
  }
  const std::span<const Vec3> all(points);
  std::vector<ClosestPoint> parts;
  for (std::size_t first = 0, size = 1; first < all.size(); first += size, size = size * 5 % 997 + 1)
    std::ranges::copy(ask(query, all.subspan(first, std::min(size, all.size() - first))), std::back_inserter(parts));
  expect_same(parts, once);
  std::ranges::reverse(points);
  std::vector<ClosestPoint> backwards = ask(query, points);
  std::ranges::reverse(backwards);
  expect_same(backwards, once);
}

// A point in front of a shared edge is equally far from both triangles, whatever the orders of their corners.
TEST(MeshQuery, TheLowestIndexAtSharedEdgesAndCorners) {
  const Mesh sphere = scenes::make("sphere", 800);
  std::vector<Vec3> points;
  for (const Triangle& t : sphere.triangles) {
    const Vec3 a = sphere.vertices[t[0]], b = sphere.vertices[t[1]];
    points.insert(points.end(), {a * 1.7, (a + b) * 0.9, (a * 0.3 + b * 0.7) * 2.0});
  }
  const std::vector<ClosestPoint> found = ask(MeshQuery(sphere, {.sign = {SignMethod::none}}), points);
  for (std::size_t n = 0; n < points.size(); ++n) {
    ASSERT_NE(found[n].feature, Feature::face);
    const auto has = [&](const Triangle& t, std::uint32_t v) { return std::ranges::count(t, v) > 0; };
    const Triangle& own = sphere.triangles[n / 3];
    std::size_t first = 0;
    while (!has(sphere.triangles[first], own[0]) || (n % 3 != 0 && !has(sphere.triangles[first], own[1]))) ++first;
    EXPECT_EQ(found[n].triangle, first) << n;
  }
}

}  // namespace
}  // namespace standoff::testing
