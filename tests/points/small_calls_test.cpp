// SPDX-License-Identifier: Apache-2.0
// Few points take another path than many: each alone down the BVH, sorted by one thread, or in blocks. All paths give
// the same bits.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstring>

#include "field/reference.h"
#include "scenes/scenes.h"
#include "standoff/points.h"
#include "tests/support/random_mesh.h"

namespace standoff::testing {
namespace {

// Random points, and points with ties and rounding: on and near corners, middles of edges and faces; far away; and
// beyond the range of boxes in float.
std::vector<Vec3> nasty_points(MeshView mesh, unsigned seed, std::size_t count) {
  Random random(seed);
  const Box box = bounds(mesh);
  const double size = std::max(box.longest_side(), 1e-300);
  const auto around = [&](double reach) { return box.center() + random.in_cube(reach * size); };
  std::vector<Vec3> points;
  while (points.size() < count) {
    const std::size_t n = points.size();
    const auto c = mesh.corners(n / 12 * 7919 % mesh.triangles.size());
    switch (n % 12) {
      case 0:
        points.push_back(c[0]);
        break;
      case 1:
        points.push_back((c[0] + c[1]) * 0.5);
        break;
      case 2:
        points.push_back((c[0] + c[1] + c[2]) * (1.0 / 3));
        break;
      case 3:
        points.push_back(c[1] + random.in_cube(1e-9 * size));
        break;
      case 4:
        points.push_back(box.center() + (c[2] - box.center()) * 2.0);
        break;
      case 5:
        points.push_back(box.center());
        break;
      case 6:
        points.push_back(around(100));
        break;
      case 7:
        points.push_back(n % 5 == 0 ? Vec3{1e140, -1e149, 3} : around(1e6));
        break;
      default:
        points.push_back(around(1));
    }
  }
  return points;
}

std::uint64_t bits(double value) { return std::bit_cast<std::uint64_t>(value); }

bool same(const ClosestPoint& a, const ClosestPoint& b) {
  bool is = bits(a.distance) == bits(b.distance) && bits(a.point.x) == bits(b.point.x) &&
            bits(a.point.y) == bits(b.point.y) && bits(a.point.z) == bits(b.point.z) && a.triangle == b.triangle &&
            a.feature == b.feature;
  for (std::size_t k = 0; k < 3; ++k) is = is && bits(a.barycentric[k]) == bits(b.barycentric[k]);
  return is;
}

// Asks about all points at once, and about some at a time.
void expect_same_answers(const MeshQuery& query, std::span<const Vec3> points) {
  std::vector<ClosestPoint> at_once(points.size()), some(points.size()), portable(points.size());
  std::vector<double> distances(points.size());
  query.closest(points, at_once);
  query.closest(points, portable, {.execution = {.simd = Simd::portable}});
  for (std::size_t n = 0; n < points.size(); ++n)
    ASSERT_TRUE(same(portable[n], at_once[n])) << "point " << n << " with portable kernels";
  query.distances(points, distances);
  for (std::size_t n = 0; n < points.size(); ++n) ASSERT_EQ(bits(distances[n]), bits(at_once[n].distance)) << n;
  for (const std::size_t count : {1, 31, 33, 500}) {
    for (std::size_t first = 0; first < points.size(); first += count) {
      const std::size_t own = std::min(count, points.size() - first);
      query.closest(points.subspan(first, own), std::span(some).subspan(first, own));
      query.distances(points.subspan(first, own), std::span(distances).subspan(first, own));
    }
    for (std::size_t n = 0; n < points.size(); ++n) {
      ASSERT_TRUE(same(some[n], at_once[n]))
          << "point " << n << ", " << count << " at a time: triangle " << some[n].triangle << " at " << some[n].distance
          << ", not " << at_once[n].triangle << " at " << at_once[n].distance;
      ASSERT_EQ(bits(distances[n]), bits(at_once[n].distance)) << "point " << n << ", " << count << " at a time";
    }
  }
}

void expect_same_answers(const Mesh& mesh, unsigned seed) {
  const std::vector<Vec3> points = nasty_points(mesh, seed, 1200);
  expect_same_answers(MeshQuery(mesh, {.sign = {SignMethod::none}}), points);
  expect_same_answers(MeshQuery(mesh, {.sign = {.method = SignMethod::winding, .as_oriented = true}}), points);
}

TEST(SmallCalls, HaveTheBitsOfLargeOnesAtScenes) {
  for (const char* const name :
       {"box", "slivers", "degenerate", "duplicate", "soup", "nested", "open", "one_triangle", "far_away", "tiny"}) {
    SCOPED_TRACE(name);
    expect_same_answers(scenes::make(name, std::string(name) == "box" ? 0 : 300), 7);
  }
}

TEST(SmallCalls, HaveTheBitsOfLargeOnesAtSoups) {
  for (unsigned seed = 0; seed < 4; ++seed) {
    SCOPED_TRACE(seed);
    expect_same_answers(random_soup(seed, 3 + 90 * static_cast<int>(seed), 4, seed % 2 ? 0.3 : 3), seed);
    expect_same_answers(nasty_soup(seed, 20 + 60 * static_cast<int>(seed), 4), seed);
  }
}

// A thread keeps a query's lists, and the next query uses them, for a smaller or a larger mesh.
TEST(SmallCalls, OfSeveralMeshesInTurns) {
  std::vector<MeshQuery> queries;
  std::vector<std::vector<double>> expected;
  Random random(3);
  std::vector<Vec3> points;
  for (int n = 0; n < 300; ++n) points.push_back(random.in_cube(2));
  for (const int triangles : {20000, 12, 300}) {
    queries.emplace_back(triangles == 12 ? scenes::make("box") : scenes::make("sphere", triangles));
    expected.emplace_back(points.size());
    for (std::size_t n = 0; n < points.size(); ++n)
      queries.back().distances(std::span(points).subspan(n, 1), std::span(expected.back()).subspan(n, 1));
  }
  std::vector<double> found(points.size());
  for (const std::size_t which : {0, 1, 2, 1, 0, 2, 0}) {
    queries[which].distances(points, found);
    EXPECT_EQ(found, expected[which]) << which;
  }
}

// A callback may ask the query that calls it.
TEST(SmallCalls, InACallback) {
  const MeshQuery query(scenes::make("sphere", 2000), {.sign = {SignMethod::none}});
  Random random(4);
  std::vector<Vec3> points;
  for (int n = 0; n < 100; ++n) points.push_back(random.in_cube(2));
  std::vector<double> expected(points.size()), found(points.size()), inner(points.size());
  query.distances(points, expected);
  for (const std::size_t count : {std::size_t{10}, points.size()}) {
    const std::span<const Vec3> some = std::span(points).last(count);
    query.distances(some, std::span(found).last(count), {.progress = [&](const Progress&) {
                      query.distances(points, inner);
                      return true;
                    }});
    EXPECT_TRUE(std::equal(expected.end() - static_cast<std::ptrdiff_t>(count), expected.end(),
                           found.end() - static_cast<std::ptrdiff_t>(count)));
    EXPECT_EQ(inner, expected);
  }
}

// For soups, the angles of all triangles are added up. Near faces, where the number jumps, it is the number of one
// side; near edges it is found as for other open meshes.
TEST(WindingNumbers, OfSoups) {
  const Mesh mesh = random_soup(5, 700, 4, 1.5);
  const MeshQuery query(mesh, {.sign = {.method = SignMethod::winding, .as_oriented = true}});
  ASSERT_EQ(query.sign().method, SignMethod::winding);
  Random random(6);
  std::vector<Vec3> points;
  for (int n = 0; n < 300; ++n) points.push_back(random.in_cube(5));
  for (int n = 0; n < 20; ++n) points.push_back(random.in_cube(1e5));
  std::vector<double> numbers(points.size()), portable(points.size());
  query.winding_numbers(points, numbers);
  query.winding_numbers(points, portable, {.execution = {.threads = 1, .simd = Simd::portable}});
  EXPECT_EQ(numbers, portable);
  for (std::size_t n = 0; n < points.size(); ++n)
    EXPECT_NEAR(numbers[n], winding_by_angles({mesh}, points[n]).value, 1e-9) << n;

  for (std::size_t t = 0; t < 200; ++t) {
    const auto c = MeshView(mesh).corners(t);
    const Vec3 at = c[0] * 0.25 + c[1] * 0.5 + c[2] * 0.25, normal = cross(c[1] - c[0], c[2] - c[0]);
    const Vec3 off = normal * (1e-7 / length(normal));
    const std::vector<Vec3> three{at - off, at, at + off};
    std::vector<double> of(3);
    query.winding_numbers(three, of);
    EXPECT_NEAR(of[0] - of[2], 1, 1e-4) << t;
    EXPECT_LT(std::min(std::abs(of[1] - of[0]), std::abs(of[1] - of[2])), 1e-4) << t;
    // Too near an edge for adding up angles.
    const Vec3 in = (c[2] - c[0]) * 1e-8, beside = (c[0] + c[1]) * 0.5 + in + off * 0.1;
    double number = 0;
    query.winding_numbers({&beside, 1}, {&number, 1});
    EXPECT_NEAR(number, winding_by_angles({mesh}, beside).value, 1e-6) << t;
  }
}

}  // namespace
}  // namespace standoff::testing
