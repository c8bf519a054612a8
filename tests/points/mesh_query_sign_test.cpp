// SPDX-License-Identifier: Apache-2.0
// Signs and winding numbers of a MeshQuery: solids with a closed form, sums of solid angles, and the samples of grids.
#include <gtest/gtest.h>

#include "field/reference.h"
#include "scenes/scenes.h"
#include "standoff/occupancy.h"
#include "standoff/points.h"
#include "tests/sign/shapes.h"
#include "tests/support/expect_error.h"
#include "tests/support/reference.h"

namespace standoff::testing {
namespace {

bool in(Vec3 p, double low, double high) { return std::min({p.x, p.y, p.z}) > low && std::max({p.x, p.y, p.z}) < high; }
bool is_on(Vec3 p, double low, double high) {
  const double least = std::min({p.x, p.y, p.z}), most = std::max({p.x, p.y, p.z});
  return least >= low && most <= high && (least == low || most == high);
}

struct Cube {
  double low, high;
};

// A lattice with every second point on the planes of cubes with whole coordinates from 0 to `high`, and the nearest
// points on both sides of these planes. Points on a cube are left out, as they may have any sign.
std::vector<Vec3> lattice(double high, std::span<const Cube> cubes) {
  std::vector<double> along;
  for (double v = -1; v <= high + 1; v += 0.5) {
    along.push_back(v);
    if (v == std::floor(v)) along.insert(along.end(), {std::nextafter(v, -100), std::nextafter(v, 100)});
  }
  std::vector<Vec3> points;
  for (const double z : along)
    for (const double y : along)
      for (const double x : along) points.push_back({x, y, z});
  std::erase_if(points, [&](Vec3 p) {
    return std::ranges::any_of(cubes, [&](const Cube& cube) { return is_on(p, cube.low, cube.high); });
  });
  return points;
}

std::vector<double> ask(const MeshQuery& query, std::span<const Vec3> points) {
  std::vector<double> distances(points.size());
  query.distances(points, distances);
  return distances;
}

// Points at distance 0 have no sign.
void expect_sides(const MeshQuery& query, std::span<const Vec3> points, const std::vector<bool>& expected) {
  const std::vector<double> found = ask(query, points);
  std::size_t wrong = 0, inside = 0;
  for (std::size_t n = 0; n < points.size(); ++n) {
    if (found[n] == 0) continue;
    inside += found[n] < 0;
    if ((found[n] < 0) == expected[n] || ++wrong > 5) continue;
    ADD_FAILURE() << "point " << n << ": " << points[n].x << ' ' << points[n].y << ' ' << points[n].z << " at "
                  << found[n];
  }
  EXPECT_EQ(wrong, 0u);
  EXPECT_GT(inside, 0u);
  EXPECT_LT(inside, points.size());
}

template <class Inside>
void expect_sides(const MeshQuery& query, std::span<const Vec3> points,
                  const Inside& is_inside) requires std::is_invocable_v<Inside, Vec3> {
  std::vector<bool> expected;
  for (const Vec3& p : points) expected.push_back(is_inside(p));
  expect_sides(query, points, expected);
}

// The order of corners changes the rounding of a distance, nothing else.
void expect_near(std::span<const double> found, std::span<const double> expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t n = 0; n < found.size(); ++n) EXPECT_NEAR(found[n], expected[n], 1e-15);
}

SignOptions by(SignMethod method) { return {.method = method}; }

TEST(MeshQuerySign, ABoxOnEveryPlaneOfItsFacesEdgesAndCorners) {
  const Mesh mesh = box({0, 0, 0}, {4, 4, 4});
  const std::vector<Vec3> points = lattice(4, std::vector<Cube>{{0, 4}});
  for (const SignMethod method : {SignMethod::winding, SignMethod::parity, SignMethod::automatic}) {
    const MeshQuery query(mesh, {.sign = by(method)});
    expect_sides(query, points, [](Vec3 p) { return in(p, 0, 4); });
    EXPECT_TRUE(query.sign().sure);
  }
  // A point that is asked alone cannot take its sign from a neighbour.
  const MeshQuery query(mesh, {.sign = by(SignMethod::winding)});
  for (const Vec3& p : points_around(1, 50, 4, {2, 2, 2})) EXPECT_EQ(ask(query, {&p, 1})[0] < 0, in(p, 0, 4));
}

TEST(MeshQuerySign, RoundSolids) {
  constexpr double kRough = 0.03;  // bounds the distance of the flat triangles from the round surface
  const auto expect_round = [&](const Mesh& mesh, double reach, const auto& height) {
    std::vector<Vec3> points = points_around(2, 4000, reach);
    std::erase_if(points, [&](Vec3 p) { return std::abs(height(p)) < kRough; });
    for (const SignMethod method : {SignMethod::winding, SignMethod::parity, SignMethod::automatic})
      expect_sides(MeshQuery(mesh, {.sign = by(method)}), points, [&](Vec3 p) { return height(p) < 0; });
  };
  expect_round(scenes::make("sphere", 2000), 1.3, [](Vec3 p) { return length(p) - 1; });
  expect_round(torus(64, 32), 1.4, [](Vec3 p) { return std::hypot(std::hypot(p.y, p.z) - 1, p.x) - 0.3; });
}

TEST(MeshQuerySign, RulesOfNestedOverlappingAndReversedSolids) {
  const Mesh outside = box({0, 0, 0}, {6, 6, 6}), within = box({2, 2, 2}, {4, 4, 4}),
             beside = box({3, 3, 3}, {8, 8, 8});
  const std::vector<Vec3> points = lattice(8, std::vector<Cube>{{0, 6}, {2, 4}, {3, 8}});
  const auto expect_rule = [&](const Mesh& mesh, WindingRule rule, const auto& is_inside) {
    SCOPED_TRACE(static_cast<int>(rule));
    expect_sides(MeshQuery(mesh, {.sign = {.method = SignMethod::winding, .rule = rule, .as_oriented = true}}), points,
                 is_inside);
  };
  const auto expect_rules = [&](const Mesh& mesh, const auto& winding) {
    expect_rule(mesh, WindingRule::positive, [&](Vec3 p) { return winding(p) > 0; });
    expect_rule(mesh, WindingRule::nonzero, [&](Vec3 p) { return winding(p) != 0; });
    expect_rule(mesh, WindingRule::odd, [&](Vec3 p) { return winding(p) % 2 != 0; });
  };
  expect_rules(joined(outside, within), [](Vec3 p) { return in(p, 0, 6) + in(p, 2, 4); });
  expect_rules(joined(outside, beside), [](Vec3 p) { return in(p, 0, 6) + in(p, 3, 8); });
  expect_rules(joined(outside, reversed(beside)), [](Vec3 p) { return in(p, 0, 6) - in(p, 3, 8); });
}

TEST(MeshQuerySign, SolidsInsideOutAreRepaired) {
  const Mesh sphere = scenes::make("sphere", 500), turned = reversed(sphere);
  const std::vector<Vec3> points = points_around(3, 2000, 1.3);
  const std::vector<double> expected = ask(MeshQuery(sphere, {.sign = by(SignMethod::automatic)}), points);
  const MeshQuery repaired(turned, {.sign = by(SignMethod::automatic)});
  expect_near(ask(repaired, points), expected);
  EXPECT_EQ(repaired.sign().flipped, std::ssize(turned.triangles));
  const MeshQuery inverted(sphere, {.sign = {.method = SignMethod::winding, .invert = true}});
  std::vector<double> negative = ask(inverted, points);
  for (double& v : negative) v = -v;
  EXPECT_EQ(negative, expected);
  Mesh muddled = sphere;
  for (std::size_t n = 0; n < muddled.triangles.size(); n += 3) muddled = with_flipped(muddled, n);
  expect_near(ask(MeshQuery(muddled, {.sign = by(SignMethod::winding)}), points), expected);
  expect_near(ask(MeshQuery(muddled, {.sign = by(SignMethod::parity)}), points), expected);
}

// The ray of each point goes through a corner or an edge of the sphere.
TEST(MeshQuerySign, RaysThroughCornersAndEdges) {
  const Mesh mesh = scenes::make("sphere", 500);
  std::vector<Vec3> points;
  for (const Triangle& t : mesh.triangles)
    for (const double x : {-2.0, -0.3, 0.0, 0.4, 2.0}) {
      const Vec3 a = mesh.vertices[t[0]], b = mesh.vertices[t[1]];
      points.insert(points.end(), {{x, a.y, a.z}, {x, (a.y + b.y) / 2, (a.z + b.z) / 2}});
    }
  expect_sides(MeshQuery(mesh, {.sign = by(SignMethod::winding)}), points,
               [&](Vec3 p) { return winding_by_angles({mesh}, p).value > 0.5; });
}

Mesh full_of_holes(Mesh mesh, std::uint32_t one_of) {
  Random random(4);
  std::erase_if(mesh.triangles, [&](const Triangle&) { return random.below(one_of) == 0; });
  return mesh;
}

TEST(MeshQuerySign, OpenMeshesAreJudgedBySolidAngles) {
  for (const std::uint32_t one_of : {100u, 8u}) {
    const Mesh mesh = full_of_holes(scenes::make("sphere", 2000), one_of);
    const MeshQuery query(mesh, {.sign = by(SignMethod::winding)});
    const std::vector<Vec3> points = points_around(5, 1500, 1.2);
    expect_sides(query, points, [&](Vec3 p) { return winding_by_angles({mesh}, p).value > 0.5; });
    std::vector<double> winding(points.size());
    query.winding_numbers(points, winding);
    for (std::size_t n = 0; n < points.size(); ++n)
      EXPECT_NEAR(winding[n], winding_by_angles({mesh}, points[n]).value, 1e-9);
  }
}

// Points so dense that most take their sign from an earlier one, around the threshold of a bowl's winding number.
TEST(MeshQuerySign, DensePointsBesideOpenMeshes) {
  Mesh bowl = scenes::make("sphere", 400);
  std::erase_if(bowl.triangles, [&](const Triangle& t) {
    return std::ranges::any_of(t, [&](std::uint32_t v) { return bowl.vertices[v].z > 0.3; });
  });
  const MeshQuery query(bowl, {.sign = {.method = SignMethod::winding}});
  const auto is_inside = [&](Vec3 p) { return winding_by_angles({bowl}, p).value > 0.5; };
  expect_sides(query, points_around(8, 12000, 1.5), is_inside);
  expect_sides(query, points_around(8, 12000, 0.2, {0.1, 0.1, 0.25}), is_inside);
  expect_sides(query, points_around(8, 12000, 0.1, {0.95, 0, 0.25}), is_inside);
}

// Points far from a small hole, on rows through it: rays from anywhere may cross its cap.
TEST(MeshQuerySign, SmallHolesFarAway) {
  const Mesh whole = sphere(24);
  for (const Vec3 side : {Vec3{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}}) {
    Mesh open = whole;
    std::erase_if(open.triangles, [&](const Triangle& t) {
      return std::ranges::all_of(t, [&](std::uint32_t v) { return dot(whole.vertices[v], side) > 0.97; });
    });
    ASSERT_LT(open.triangles.size(), whole.triangles.size());
    std::vector<Vec3> points = points_around(21, 200, 1.2);
    for (const double along : {-1.3, -0.95, -0.9, -0.5, -0.1, 0.0, 0.3, 0.7, 0.95, 1.5, 20.0})
      for (const double off : {0.0, 0.01, 0.05}) points.push_back(side * along + Vec3{off, off / 2, off / 3});
    const MeshQuery query(open, {.sign = {.method = SignMethod::winding, .as_oriented = true}});
    std::vector<double> winding(points.size());
    query.winding_numbers(points, winding);
    for (std::size_t n = 0; n < points.size(); ++n)
      EXPECT_NEAR(winding[n], winding_by_angles({open}, points[n]).value, 1e-8);
  }
}

TEST(MeshQuerySign, WindingNumbersOfClosedMeshesAreWhole) {
  const Mesh mesh =
      joined(joined(box({0, 0, 0}, {6, 6, 6}), box({2, 2, 2}, {4, 4, 4})), reversed(box({3, 3, 3}, {8, 8, 8})));
  const MeshQuery query(mesh, {.sign = {.method = SignMethod::winding, .as_oriented = true}});
  std::vector<Vec3> points = points_around(6, 3000, 5, {4, 4, 4});
  points.push_back({1e100, -1e150, 3});
  std::vector<double> winding(points.size(), 7);
  query.winding_numbers(points, winding);
  for (std::size_t n = 0; n < points.size(); ++n)
    EXPECT_EQ(winding[n], in(points[n], 0, 6) + in(points[n], 2, 4) - in(points[n], 3, 8));
  for (const SignMethod method : {SignMethod::none, SignMethod::parity, SignMethod::normal})
    expect_error([&] { MeshQuery(mesh, {.sign = by(method)}).winding_numbers(points, winding); }, ErrorCode::usage,
                 "winding");
}

TEST(MeshQuerySign, NormalsOfAConvexSolidSayTheSame) {
  const Mesh mesh = scenes::make("sphere", 500);
  std::vector<Vec3> points = points_around(7, 3000, 1.3);
  for (const Vec3& v : mesh.vertices) points.insert(points.end(), {v * 0.9, v * 1.1});
  EXPECT_EQ(ask(MeshQuery(mesh, {.sign = by(SignMethod::normal)}), points),
            ask(MeshQuery(mesh, {.sign = by(SignMethod::winding)}), points));
  const Mesh sheet{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {{0, 1, 2}}};
  expect_sides(MeshQuery(sheet, {.sign = by(SignMethod::normal)}), points_around(8, 500, 0.4, {1, 1, 0}),
               [](Vec3 p) { return p.z < 0; });
}

// The inner box has inside on both sides.
TEST(MeshQuerySign, OuterMeasuresFromTheUnion) {
  const Mesh outside = box({0, 0, 0}, {6, 6, 6}), both = joined(outside, box({2, 2, 2}, {4, 4, 4}));
  const MeshQuery query(both, {.sign = {.method = SignMethod::winding, .outer = true}});
  EXPECT_EQ(query.sign().internal, 12);
  const std::vector<Vec3> points = points_around(9, 3000, 4, {3, 3, 3});
  EXPECT_EQ(ask(query, points), ask(MeshQuery(outside, {.sign = by(SignMethod::winding)}), points));
  std::vector<ClosestPoint> closest(points.size());
  query.closest(points, closest);
  for (const ClosestPoint& it : closest) EXPECT_LT(it.triangle, 12u);
  EXPECT_EQ(ask(query, std::vector<Vec3>{{3, 3, 3}})[0], -3);
}

// A ball without exposed triangles may hold hidden ones, so the winding number may change within it. Once a point
// outside took the number of a ball whose centre is behind hidden faces.
TEST(MeshQuerySign, OuterCountsNoHiddenFacesWithinABall) {
  const Mesh both = joined(box({0, 0, 0}, {6, 6, 6}), box({0.02, 0.02, 0.02}, {5.98, 5.98, 5.98}));
  const MeshQuery query(both, {.sign = {.method = SignMethod::winding, .outer = true}});
  const std::vector<Vec3> points = points_around(11, 30000, 0.06, {6, 3, 5.97});
  const std::vector<double> found = ask(query, points);
  for (std::size_t n = 0; n < points.size(); ++n) EXPECT_EQ(found[n] < 0, in(points[n], 0, 6)) << n;
}

TEST(MeshQuerySign, ShellsAndNone) {
  const Mesh mesh{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}}, {{0, 1, 2}}};
  const std::vector<Vec3> points{{1, 1, 0}, {1, 1, 0.25}, {1, 1, -3}, {1, 1, 0.5}};
  const SignOptions shell{.method = SignMethod::shell, .shell = 1};
  SignOptions inverted = shell;
  inverted.invert = true;
  EXPECT_EQ(ask(MeshQuery(mesh, {.sign = shell}), points), (std::vector<double>{-0.5, -0.25, 2.5, 0}));
  EXPECT_EQ(ask(MeshQuery(mesh, {.sign = inverted}), points), (std::vector<double>{0.5, 0.25, -2.5, 0}));
  EXPECT_EQ(ask(MeshQuery(mesh, {.sign = {SignMethod::none}}), points), (std::vector<double>{0, 0.25, 3, 0.5}));
}

TEST(MeshQuerySign, SheetsHaveNone) {
  const Mesh sheet = scenes::make("terrain", 500);
  const MeshQuery query(sheet, {.sign = by(SignMethod::automatic)});
  EXPECT_EQ(query.sign().method, SignMethod::none);
  EXPECT_FALSE(query.sign().sure);
  EXPECT_NE(query.sign().why.find("sheet"), std::string::npos) << query.sign().why;
  const std::vector<Vec3> points = points_around(10, 500, 60);
  EXPECT_EQ(ask(query, points), ask(MeshQuery(sheet, {.sign = {SignMethod::none}}), points));
  expect_error([&] { MeshQuery(sheet, {.sign = {.method = SignMethod::automatic, .strict = true}}); }, ErrorCode::doubt,
               "sheet");
  expect_error([&] { MeshQuery(sheet, {.sign = by(SignMethod::flood)}); }, ErrorCode::usage, "grid");
  expect_error([&] { MeshQuery(sheet, {.sign = by(SignMethod::parity)}); }, ErrorCode::input, "parity");
  // A mesh that needs flooding has no sign here, and the report says so.
  const MeshQuery bottle(klein_bottle(), {.sign = by(SignMethod::automatic)});
  EXPECT_EQ(bottle.sign().method, SignMethod::none);
  EXPECT_NE(bottle.sign().why.find("grid"), std::string::npos) << bottle.sign().why;
}

TEST(MeshQuerySign, TheSidesOfAGridsSamples) {
  const auto expect_same = [](const Mesh& mesh, const SignOptions& sign) {
    const Box box = bounds(mesh);
    const double spacing = box.longest_side() / 24;
    Grid grid{{29, 29, 29}, box.min - Vec3{1, 1, 1} * (2 * spacing), {spacing, spacing, spacing}};
    const Occupancy samples = occupancy(mesh, grid, {.sign = sign});
    std::vector<Vec3> points;
    std::vector<bool> inside;
    for (std::int64_t k = 0; k < 29; ++k)
      for (std::int64_t j = 0; j < 29; ++j)
        for (std::int64_t i = 0; i < 29; ++i) {
          points.push_back(grid.position(i, j, k));
          inside.push_back(samples.inside(i, j, k));
        }
    expect_sides(MeshQuery(mesh, {.sign = sign}), points, inside);
  };
  for (const char* name : {"nested", "sphere", "box", "catapult", "machine_1"}) {
    SCOPED_TRACE(name);
    const Mesh mesh = scenes::make(name, 2000);
    for (const WindingRule rule : {WindingRule::positive, WindingRule::odd})
      expect_same(mesh, {.method = SignMethod::winding, .rule = rule});
  }
  expect_same(scenes::make("nested", 2000), by(SignMethod::parity));
  expect_same(full_of_holes(scenes::make("sphere", 2000), 50), by(SignMethod::automatic));
}

}  // namespace
}  // namespace standoff::testing
