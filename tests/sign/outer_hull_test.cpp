// SPDX-License-Identifier: Apache-2.0
// Rooms whose walls are there once, with every triangle turned at random: whatever shape they have together, what
// cannot be reached from outside is inside, and all else is outside.
#include <gtest/gtest.h>

#include <array>
#include <set>

#include "sign/diagnosis/orient.h"
#include "sign/oriented_mesh.h"
#include "tests/sign/brute_winding.h"
#include "tests/sign/cases/solids.h"
#include "tests/sign/shapes.h"

namespace standoff {
namespace {

using namespace testing;

// Rooms with all walls, of which those that two rooms share are left out once.
Mesh with_walls_once(const std::vector<Mesh>& rooms) {
  Mesh all;
  for (const Mesh& room : rooms) all = joined(std::move(all), room);
  std::set<std::array<std::array<double, 3>, 3>> seen;
  std::erase_if(all.triangles, [&](const Triangle& t) {
    std::array<std::array<double, 3>, 3> face;
    for (std::size_t n = 0; n < 3; ++n) face[n] = {all.vertices[t[n]].x, all.vertices[t[n]].y, all.vertices[t[n]].z};
    std::ranges::sort(face);
    return !seen.insert(face).second;
  });
  return all;
}

struct Found {
  Orientation orientation;
  Mesh used;
};
Found orient_damaged(const Mesh& whole, unsigned seed) {
  std::int64_t turned = 0;
  const Mesh mesh = shuffled(randomly_turned(whole, seed, turned), seed + 1);
  Found found{orient(mesh, MeshEdges(mesh)), {mesh.vertices, {}}};
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const int use = OrientedMesh{mesh, found.orientation.use}.use_of(t);
    if (use == 0) continue;
    found.used.triangles.push_back(mesh.triangles[t]);
    if (use < 0) std::swap(found.used.triangles.back()[1], found.used.triangles.back()[2]);
  }
  return found;
}

void expect_sides(const Mesh& whole, const std::vector<Vec3>& inside, const std::vector<Vec3>& outside,
                  unsigned seeds) {
  for (unsigned seed = 0; seed < seeds; ++seed) {
    const Found found = orient_damaged(whole, seed);
    EXPECT_EQ(found.orientation.boundary_edges, 0) << seed;
    EXPECT_EQ(found.orientation.walls + std::ssize(found.used.triangles), std::ssize(whole.triangles)) << seed;
    for (const Vec3& p : inside) EXPECT_NEAR(brute_winding(found.used, p).value, 1, 1e-9) << seed;
    for (const Vec3& p : outside) EXPECT_NEAR(brute_winding(found.used, p).value, 0, 1e-9) << seed;
  }
}

// Unit cubes of a lattice.
class Cubes {
 public:
  explicit Cubes(int side) : side_(side), full_(static_cast<std::size_t>(side * side * side)) {}
  std::uint8_t& full(int i, int j, int k) { return full_[index(i, j, k)]; }

  void expect_enclosed(unsigned seeds) const {
    std::vector<Mesh> rooms;
    std::vector<Vec3> inside, outside;
    const std::vector<std::uint8_t> reached = reached_from_outside();
    for (int k = 0; k < side_; ++k)
      for (int j = 0; j < side_; ++j)
        for (int i = 0; i < side_; ++i) {
          const Vec3 low{double(i), double(j), double(k)};
          if (full_[index(i, j, k)] != 0) rooms.push_back(moved(box(), low));
          (reached[index(i, j, k)] != 0 ? outside : inside).push_back(low + Vec3{0.4, 0.55, 0.37});
        }
    expect_sides(with_walls_once(rooms), inside, outside, seeds);
  }

 private:
  std::size_t index(int i, int j, int k) const { return static_cast<std::size_t>(i + side_ * (j + side_ * k)); }

  // Through the faces of empty cells.
  std::vector<std::uint8_t> reached_from_outside() const {
    std::vector<std::uint8_t> reached(full_.size());
    const auto is_reached = [&](int i, int j, int k) {
      return i < 0 || j < 0 || k < 0 || i == side_ || j == side_ || k == side_ || reached[index(i, j, k)] != 0;
    };
    for (bool more = true; more;) {
      more = false;
      for (int k = 0; k < side_; ++k)
        for (int j = 0; j < side_; ++j)
          for (int i = 0; i < side_; ++i) {
            const std::size_t n = index(i, j, k);
            if (full_[n] != 0 || reached[n] != 0) continue;
            reached[n] = is_reached(i - 1, j, k) || is_reached(i + 1, j, k) || is_reached(i, j - 1, k) ||
                         is_reached(i, j + 1, k) || is_reached(i, j, k - 1) || is_reached(i, j, k + 1);
            more = more || reached[n] != 0;
          }
    }
    return reached;
  }

  int side_;
  std::vector<std::uint8_t> full_;
};

Cubes block(int side, int x, int y, int z) {
  Cubes cubes(side);
  for (int k = 0; k < z; ++k)
    for (int j = 0; j < y; ++j)
      for (int i = 0; i < x; ++i) cubes.full(i, j, k) = 1;
  return cubes;
}

TEST(OuterHull, RoomsInARow) {
  for (const int count : {2, 3, 5}) block(5, count, 1, 1).expect_enclosed(10);
}

TEST(OuterHull, BlocksOfRooms) {
  block(3, 2, 2, 1).expect_enclosed(10);
  block(3, 2, 2, 2).expect_enclosed(10);
  block(4, 3, 3, 3).expect_enclosed(5);
}

TEST(OuterHull, RoomsAroundACourtAndAroundARoom) {
  Cubes court = block(4, 3, 3, 1), hollow = block(4, 3, 3, 3), corner = block(4, 3, 3, 1);
  court.full(1, 1, 0) = 0;
  court.expect_enclosed(10);
  hollow.full(1, 1, 1) = 0;  // a room like the others: its walls are there once
  hollow.expect_enclosed(5);
  for (const int i : {1, 2})
    for (const int j : {0, 1}) corner.full(i, j, 0) = 0;
  corner.expect_enclosed(10);
}

TEST(OuterHull, AnyRooms) {
  Random random(7);
  for (int n = 0; n < 30; ++n) {
    Cubes cubes(4);
    for (int k = 0; k < 4; ++k)
      for (int j = 0; j < 4; ++j)
        for (int i = 0; i < 4; ++i) cubes.full(i, j, k) = random.between(0, 1) < 0.2 + 0.02 * n;
    SCOPED_TRACE(n);
    cubes.expect_enclosed(2);
  }
}

// A prism over a polygon about a point, from z = 0 to 1. Its sides are cut as those of a neighbour are, or otherwise.
Mesh room(const std::vector<std::pair<double, double>>& polygon, Vec3 center, bool as_neighbours) {
  Mesh mesh;
  const Vec3 up{0, 0, 1};
  for (std::size_t n = 0; n < polygon.size(); ++n) {
    const auto [ax, ay] = polygon[n];
    const auto [bx, by] = polygon[(n + 1) % polygon.size()];
    const Vec3 a{ax, ay, 0}, b{bx, by, 0};
    const bool first = !as_neighbours || polygon[n] < polygon[(n + 1) % polygon.size()];
    add_triangle(mesh, a, b, first ? b + up : a + up);
    add_triangle(mesh, first ? a : b, b + up, a + up);
    add_triangle(mesh, b, a, center);
    add_triangle(mesh, a + up, b + up, center + up);
  }
  return mesh;
}

// Prisms over hexagons, which tile the plane: three walls meet at inner edges, so no turn of them all would cancel. If
// walls are there twice and cut differently, they are no copies, and enclose cells without a volume.
TEST(OuterHull, Honeycombs) {
  const std::vector<std::pair<double, double>> corners = {{0, 0}, {1, 0}, {2, 1}, {2, 2}, {1, 2}, {0, 1}};
  for (const bool as_neighbours : {true, false}) {
    SCOPED_TRACE(as_neighbours);
    std::vector<Mesh> rooms;
    std::vector<Vec3> inside;
    for (int i = 0; i < 5; ++i)
      for (int j = 0; j < 4; ++j) {
        const double x = 2 * i + j, y = i + 2 * j;
        std::vector<std::pair<double, double>> cell;
        for (const auto& [u, v] : corners) cell.emplace_back(x + u, y + v);
        rooms.push_back(room(cell, {x + 1, y + 1, 0}, as_neighbours));
        inside.push_back({x + 1.1, y + 1.2, 0.4});
        inside.push_back({x + 0.6, y + 0.4, 0.9});
      }
    expect_sides(with_walls_once(rooms), inside, {{-1, 0, 0.5}, {3, 0.25, 0.5}, {5, 5, -0.1}, {5, 5, 1.1}, {0, 9, 0.5}},
                 10);
  }
}

TEST(OuterHull, AWallWithADoor) {
  Mesh rooms = with_walls_once({box({4, 0, 0}, {5, 1, 1}), box({5, 0, 0}, {6, 1, 1})});
  std::erase_if(rooms.triangles, [&](const Triangle& t) {
    return std::ranges::all_of(t, [&](std::uint32_t v) { return rooms.vertices[v].x == 5; });
  });
  ASSERT_EQ(rooms.triangles.size(), 20u);
  const std::array<Vec3, 4> wall = {{{5, 0, 0}, {5, 1, 0}, {5, 1, 1}, {5, 0, 1}}};
  for (std::size_t n = 0; n < 4; ++n) {
    const Vec3 a = wall[n], b = wall[(n + 1) % 4], middle{5, 0.5, 0.5};
    add_triangle(rooms, a, b, (b + middle) * 0.5);
    add_triangle(rooms, a, (b + middle) * 0.5, (a + middle) * 0.5);
  }
  expect_sides(rooms, {{4.5, 0.4, 0.3}, {5.5, 0.3, 0.4}, {4.9, 0.1, 0.1}}, {{4.5, -0.1, 0.5}, {5.2, 0.5, 1.1}}, 10);
}

// A brim around a ball cuts it in two; its plane is outside on both sides.
TEST(OuterHull, ABrim) {
  const Mesh ball = sphere(8);
  Mesh mesh = ball;
  for (int n = 0; n < 16; ++n) {
    const auto at = [&](int m, double r) {
      const Vec3 p = ball.vertices[static_cast<std::size_t>(m % 16 + 17 * 4)];
      return Vec3{p.x * r, p.y * r, p.z};
    };
    add_triangle(mesh, at(n, 1), at(n + 1, 1), at(n, 2));
    add_triangle(mesh, at(n + 1, 1), at(n + 1, 2), at(n, 2));
  }
  expect_sides(mesh, {{0, 0, 0}, {0.9, 0, 0.1}}, {{1.5, 0, 0.1}, {1.5, 0, -0.1}}, 10);
  EXPECT_EQ(orient_damaged(mesh, 1).orientation.walls, 32);
}

// Three sheets that meet at a line enclose nothing: all of them stay.
// A hole of four edges that is filled along both of its diagonals, where a triangle beside it passes through: around
// that edge the surface lies between the two fillings, so that its front and its back seem to be one cell.
TEST(OuterHull, AHoleThatIsFilledTwice) {
  Mesh mesh = sphere(16);
  const double whole = brute_winding(mesh, {0.01, 0.02, 0.03}).value;
  ASSERT_NEAR(whole, 1, 1e-9);
  const auto neighbour = [&](std::uint32_t from, std::uint32_t to) {  // the corner beyond an edge
    for (const Triangle& t : mesh.triangles)
      for (std::size_t n = 0; n < 3; ++n)
        if (t[n] == from && t[(n + 1) % 3] == to) return t[(n + 2) % 3];
    return ~0u;
  };
  const std::size_t before = mesh.triangles.size();
  const Triangle first = mesh.triangles[before / 2 + 32];  // away from the seam, where vertices stand twice
  const std::uint32_t a = first[0], b = first[1], c = first[2], d = neighbour(a, c), e = neighbour(b, a);
  ASSERT_TRUE(d != ~0u && e != ~0u && e != c && e != d);
  // The quadrangle a, b, c, d bulges, and e is within its bulge.
  auto& v = mesh.vertices;
  v[c] = v[c] * 1.3, v[a] = v[a] * 1.3;
  v[e] = (v[a] + v[b]) * 0.3 + (v[c] + v[d]) * 0.2;
  mesh.triangles.push_back({a, b, d});
  mesh.triangles.push_back({b, c, d});
  const Found found = orient_damaged(mesh, 3);
  EXPECT_EQ(found.orientation.boundary_edges, 0);
  EXPECT_EQ(found.orientation.walls, 2);
  EXPECT_EQ(found.used.triangles.size(), before);
  for (const Vec3& p : {Vec3{0.01, 0.02, 0.03}, Vec3{-0.3, 0.2, 0.1}, Vec3{0.1, -0.4, -0.2}})
    EXPECT_NEAR(brute_winding(found.used, p).value, 1, 1e-9);
  EXPECT_NEAR(brute_winding(found.used, {2, 2, 2}).value, 0, 1e-9);
}

TEST(OuterHull, SheetsHaveNone) {
  Mesh mesh;
  for (int n = 0; n < 3; ++n) {
    const Vec3 out{std::cos(2.0 * n), std::sin(2.0 * n), 0}, up{0, 0, 1};
    add_triangle(mesh, {}, out, out + up);
    add_triangle(mesh, {}, out + up, up);
  }
  for (unsigned seed = 0; seed < 20; ++seed) {
    const Orientation found = orient_damaged(mesh, seed).orientation;
    EXPECT_EQ(found.walls, 0);
    EXPECT_EQ(found.patches, 3);
    EXPECT_EQ(found.boundary_edges, 10);
  }
}

// Rooms that are oriented well, walls and all, give the same result; a second time nothing changes.
TEST(OuterHull, AgainNothingChanges) {
  const Mesh rooms = with_walls_once({box(), box({1, 0, 0}, {2, 1, 1}), box({2, 0, 0}, {3, 1, 1})});
  const Orientation found = orient(rooms, MeshEdges(rooms));
  EXPECT_EQ(found.flipped, 0);
  EXPECT_EQ(found.walls, 4);
  EXPECT_EQ(found.left_out, 4);
  const Mesh used = orient_damaged(rooms, 3).used;
  EXPECT_TRUE(orient(used, MeshEdges(used)).use.empty());
}

}  // namespace
}  // namespace standoff
