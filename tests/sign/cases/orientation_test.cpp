// SPDX-License-Identifier: Apache-2.0
// Triangles that look the wrong way: one, some, all, or at random. Repaired, the solid is what it was.
#include <gtest/gtest.h>

#include "tests/sign/cases/known_sides.h"
#include "tests/sign/cases/solids.h"

namespace standoff {
namespace {

using namespace testing;  // NOLINT: a test of what that folder has

TEST(OrientationCases, SolidTurnedInsideOut) {
  const Mesh ball = sphere(8), outside_in = reversed(ball);
  const Grid grid = grid_around(ball, 20);
  for (const SignOptions& sign : {kWinding, kAutomatic}) {
    const SignReport report = expect_sides(outside_in, grid, sign, Convex(ball));
    EXPECT_EQ(report.flipped, std::ssize(ball.triangles));
    EXPECT_EQ(report.boundary_edges, 0);
  }
  expect_sides(outside_in, grid, kAsOriented, [](Vec3) { return Side::outside; });
  SignOptions nonzero = kAsOriented;
  nonzero.rule = WindingRule::nonzero;
  expect_sides(outside_in, grid, nonzero, Convex(ball));
}

TEST(OrientationCases, OneInsideOutAmongMany) {
  Mesh mesh;
  std::vector<Convex> solids;
  const Mesh ball = sphere(5);
  for (int n = 0; n < 12; ++n) {
    const Mesh one = moved(ball, {2.2 * (n % 3), 2.2 * (n / 3 % 2), 2.2 * (n / 6)});
    solids.emplace_back(one);
    mesh = joined(std::move(mesh), n == 7 ? reversed(one) : one);
  }
  const Grid grid = grid_around(mesh, 24);
  for (const SignOptions& sign : {kWinding, kAutomatic}) {
    const SignReport report = expect_sides(mesh, grid, sign, [&](Vec3 p) { return in_any(solids, p); });
    EXPECT_EQ(report.flipped, std::ssize(ball.triangles));
  }
  std::vector<Convex> others = solids;
  others.erase(others.begin() + 7);
  const SignReport report = expect_sides(mesh, grid, kAsOriented, [&](Vec3 p) { return in_any(others, p); });
  EXPECT_EQ(report.flipped, 0);
}

TEST(OrientationCases, SolidsOfUnorientedTriangles) {
  struct Case {
    const char* name;
    Mesh mesh;
  };
  for (const auto& [name, whole] : {Case{"ball", sphere(9)}, Case{"box", box({-1, -2, -3}, {1, 1, 1})}}) {
    SCOPED_TRACE(name);
    const Convex known(whole);
    const Grid grid = grid_around(whole, 15);
    for (unsigned seed = 0; seed < 6; ++seed) {
      SCOPED_TRACE(seed);
      std::int64_t turned = 0;
      Mesh mesh = shuffled(randomly_turned(whole, seed, turned), seed);
      if (seed % 2 == 0) mesh = unwelded(mesh);
      const std::uint64_t before = content_hash(mesh);
      for (const SignOptions& sign : {kWinding, kAutomatic}) {
        const SignReport report = expect_sides(mesh, grid, sign, known);
        EXPECT_EQ(report.flipped, turned);
        EXPECT_EQ(report.boundary_edges, 0);
        EXPECT_TRUE(report.sure) << report.why;
      }
      EXPECT_EQ(content_hash(mesh), before) << "the caller's mesh was changed";
      if (seed > 1) continue;
      const SignReport report = expect_sides(mesh, grid, kAsOriented, ByWinding(mesh, grid));
      EXPECT_EQ(report.flipped, 0);
      EXPECT_GT(report.boundary_edges, 0);
    }
  }
}

TEST(OrientationCases, ManyBodiesOfUnorientedTriangles) {
  Mesh mesh;
  std::vector<Convex> solids;
  const Mesh ring = torus(24, 12);
  for (int n = 0; n < 6; ++n) {
    const Mesh one = moved(n % 2 == 0 ? sphere(4) : box({-0.7, -0.7, -0.7}, {0.7, 0.7, 0.7}), {1.5 * n, 0.3 * n, 3});
    solids.emplace_back(one);
    mesh = joined(std::move(mesh), one);
  }
  mesh = joined(std::move(mesh), ring);
  std::int64_t turned = 0;
  mesh = shuffled(randomly_turned(std::move(mesh), 3, turned), 4);
  const RoundTorus in_ring(24, 12, 1, 0.3);
  const SignReport report = expect_sides(mesh, grid_around(mesh, 28), kWinding, [&](Vec3 p) {
    const Side side = in_any(solids, p);
    return side == Side::outside ? in_ring(p) : side;
  });
  EXPECT_EQ(report.flipped, turned);
}

// Two rooms share a wall, so three patches meet at its edges. Whichever way it looks, what it adds is less than 1/2 on
// either side: the two rooms are inside.
TEST(OrientationCases, PatchesThatMeetInThrees) {
  const Mesh a = box({0, 0, 0}, {1, 1, 1}), both = box({0, 0, 0}, {2, 1, 1});
  Mesh whole;  // two boxes, and the face x = 1 of both just once
  for (const Mesh& one : {a, moved(a, {1, 0, 0})}) whole = joined(std::move(whole), one);
  std::vector<Triangle> kept;
  for (std::size_t t = 0; t < whole.triangles.size(); ++t) {
    const auto [p, q, r] = MeshView(whole).corners(t);
    if (t < a.triangles.size() || p.x != 1 || q.x != 1 || r.x != 1) kept.push_back(whole.triangles[t]);
  }
  ASSERT_EQ(kept.size(), 22u);
  whole.triangles = kept;
  for (unsigned seed = 0; seed < 8; ++seed) {
    SCOPED_TRACE(seed);
    std::int64_t turned = 0;
    const Mesh mesh = shuffled(randomly_turned(whole, seed, turned), seed);
    for (const SignOptions& sign : {kWinding, kAutomatic})
      expect_sides(mesh, grid_around(mesh, 18), sign, Convex(both));
  }
}

// A ball cut into patches of which each looks one way: positions join them, whoever their vertices belong to.
TEST(OrientationCases, PatchesThatLookAtRandom) {
  const Mesh ball = sphere(10);
  for (unsigned seed = 0; seed < 4; ++seed) {
    Mesh mesh = unwelded(ball);
    std::int64_t turned = 0;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const Vec3 p = ball.vertices[ball.triangles[t][0]];
      const unsigned patch = (p.x > 0.1) + 2 * (p.y > -0.2) + 4 * (p.z > 0.3);
      if ((0x5a3c96u >> (patch + 5 * seed) & 1) == 0) continue;
      std::swap(mesh.triangles[t][0], mesh.triangles[t][1]);
      ++turned;
    }
    const SignReport report = expect_sides(mesh, grid_around(ball, 20), kWinding, Convex(ball));
    EXPECT_EQ(report.flipped, turned);
  }
}

// The scan of a room: what its walls enclose is free, all else is not. Its triangles look inwards.
TEST(OrientationCases, RoomScannedFromInside) {
  const Mesh solid = box({0, 0, 0}, {4, 3, 5});
  const Convex in_room(solid);
  const auto is_wall = [&](Vec3 p) {
    const Side side = in_room(p);
    return side == Side::unknown ? side : side_of(side == Side::outside);
  };
  const Grid grid = grid_around(solid, 22);
  const Mesh room = reversed(solid);
  expect_sides(room, grid, {.method = SignMethod::winding, .invert = true}, is_wall);
  expect_sides(room, grid, {.method = SignMethod::automatic, .invert = true}, is_wall);
  expect_sides(room, grid, {.method = SignMethod::parity, .invert = true}, is_wall);
  expect_sides(room, grid, {.method = SignMethod::flood, .invert = true}, is_wall);
  expect_sides(room, grid, {.method = SignMethod::normal, .as_oriented = true}, is_wall);
  expect_sides(room, grid,
               {.method = SignMethod::winding, .rule = WindingRule::nonzero, .invert = true, .as_oriented = true},
               is_wall);
  // Without its ceiling, the room ends where the missing face would be: a flat hole has a winding number below 1/2 on
  // its outer side, above on the other.
  Mesh open = room;
  std::erase_if(open.triangles, [&](const Triangle& t) {
    return std::ranges::all_of(t, [&](std::uint32_t v) { return open.vertices[v].z == 5; });
  });
  ASSERT_EQ(open.triangles.size(), 10u);
  for (const WindingRule rule : {WindingRule::positive, WindingRule::nonzero}) {
    const SignReport report =
        expect_sides(open, grid, {.method = SignMethod::winding, .rule = rule, .invert = true}, is_wall);
    EXPECT_EQ(report.boundary_edges, 4);
  }
}

}  // namespace
}  // namespace standoff
