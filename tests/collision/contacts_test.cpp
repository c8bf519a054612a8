// SPDX-License-Identifier: Apache-2.0
// Contacts against every pair of triangles.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <set>

#include "standoff/collision.h"
#include "tests/collision/bodies.h"

namespace standoff {
namespace {

using namespace standoff::testing;
using Pairs = std::set<std::pair<std::uint32_t, std::uint32_t>>;

Pairs brute_pairs(const Mesh& a, const Pose& pose_a, const Mesh& b, const Pose& pose_b, double margin) {
  Pairs pairs;
  for (std::uint32_t s = 0; s < a.triangles.size(); ++s)
    for (std::uint32_t t = 0; t < b.triangles.size(); ++t) {
      const Corners p = corners_at(a, s, pose_a), q = corners_at(b, t, pose_b);
      if (triangles_intersect(p, q) || (margin > 0 && closest_points(p, q).distance_sq <= margin * margin))
        pairs.insert({s, t});
    }
  return pairs;
}

void expect_contacts_of_brute_force(const Mesh& a, const Mesh& b, int poses, double half, double margin,
                                    unsigned seed) {
  const Body model_a(a), model_b(b);
  Random random(seed);
  std::size_t touching = 0;
  for (int n = 0; n < poses; ++n) {
    SCOPED_TRACE("pose " + std::to_string(n));
    const Pose pose_a = n % 2 ? Pose{} : random_pose(random, half), pose_b = random_pose(random, half);
    const Pairs expected = brute_pairs(a, pose_a, b, pose_b, margin);
    touching += !expected.empty();
    const ContactResult all = contacts(model_a, pose_a, model_b, pose_b, {.most = 1'000'000, .margin = margin});
    EXPECT_FALSE(all.overflow);
    Pairs found;
    for (const ContactPoint& c : all.contacts) {
      found.insert({c.triangle_a, c.triangle_b});
      ASSERT_NEAR(length(c.normal), 1, 1e-9);
      // Moved along the normal by its depth, the pair is apart.
      Pose out = pose_b;
      out.translation = out.translation + c.normal * (c.depth + 1e-9);
      const bool still = triangles_intersect(corners_at(a, c.triangle_a, pose_a), corners_at(b, c.triangle_b, out));
      EXPECT_FALSE(c.depth >= 0 && still);
    }
    EXPECT_EQ(found, expected);
    EXPECT_EQ(found.size(), all.contacts.size());
    if (expected.size() < 2) continue;
    const auto half_of_them = static_cast<std::int64_t>(expected.size() / 2);
    const ContactResult some = contacts(model_a, pose_a, model_b, pose_b, {.most = half_of_them, .margin = margin});
    EXPECT_TRUE(some.overflow);
    EXPECT_EQ(some.contacts.size(), half_of_them);
    for (const ContactPoint& c : some.contacts) EXPECT_TRUE(expected.contains({c.triangle_a, c.triangle_b}));
    EXPECT_FALSE(contacts(model_a, pose_a, model_b, pose_b,
                          {.most = static_cast<std::int64_t>(expected.size()), .margin = margin})
                     .overflow);
  }
  EXPECT_GT(touching, poses / 10);
}

TEST(Contacts, AreAllPairsThatTouch) {
  expect_contacts_of_brute_force(ball_mesh(1, 5), ball_mesh(0.5, 4), 100, 1, 0, 1);
  expect_contacts_of_brute_force(ball_mesh(0.5, 4), ball_mesh(1, 5), 100, 1, 0, 2);
  expect_contacts_of_brute_force(random_soup(3, 60, 1, 0.5), random_soup(4, 60, 1, 0.5), 50, 1, 0, 3);
}

TEST(Contacts, AreAllPairsWithinTheMargin) {
  expect_contacts_of_brute_force(ball_mesh(1, 3), ball_mesh(0.5, 3), 50, 1, 0.1, 4);
}

// A flat plate of triangles in the middle of the world, its points moved by `height`.
template <class Height>
Mesh plate(int cells, double side, Height height) {
  Mesh mesh;
  const auto at = [&](int u, int v) {
    const double s = side / cells;
    return Vec3{u * s - side / 2, v * s - side / 2, height(u, v)};
  };
  for (int i = 0; i < cells; ++i)
    for (int j = 0; j < cells; ++j) {
      add_triangle(mesh, at(i, j), at(i + 1, j), at(i, j + 1));
      add_triangle(mesh, at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
    }
  return mesh;
}

// A query returns as many contacts as it asks for, if they exist, and `overflow` says whether there are more.
void expect_so_many_as_wanted(const Mesh& a, const Mesh& b, std::size_t expected) {
  const Body model_a(a), model_b(b);
  const auto all = static_cast<std::int64_t>(expected);
  for (const std::int64_t most : {std::int64_t{1}, std::int64_t{7}, std::int64_t{100}, all - 1, all, all + 1}) {
    if (most < 1) continue;
    const ContactResult found = contacts(model_a, {}, model_b, {}, {.most = most});
    EXPECT_EQ(found.contacts.size(), std::min(expected, static_cast<std::size_t>(most))) << "of " << most;
    EXPECT_EQ(found.overflow, most < all) << "of " << most;
    Pairs pairs;
    for (const ContactPoint& c : found.contacts) {
      EXPECT_TRUE(triangles_intersect(corners_at(a, c.triangle_a, {}), corners_at(b, c.triangle_b, {})));
      pairs.insert({c.triangle_a, c.triangle_b});
    }
    EXPECT_EQ(pairs.size(), found.contacts.size());
  }
}

// In the same place, each triangle touches itself and the triangles that share a corner with it: 13 in all inside a
// plate.
TEST(Contacts, OfBodiesInTheSamePlaceAreAllNeighbours) {
  constexpr int kCells = 80;
  const Mesh wave = plate(kCells, 2, [](int u, int v) { return 0.02 * std::sin(0.7 * u + 0.3 * v); });
  // Count pairs by common corners: n triangles at a corner make n^2 pairs, which count twice for edges, thrice for
  // copies.
  const auto key = [](Vec3 p) { return std::array{p.x, p.y, p.z}; };
  std::map<std::array<double, 3>, std::vector<std::uint32_t>> around;
  for (std::uint32_t t = 0; t < wave.triangles.size(); ++t)
    for (const Vec3& corner : corners_at(wave, t, {})) around[key(corner)].push_back(t);
  Pairs pairs;
  for (const auto& [corner, triangles] : around)
    for (const std::uint32_t s : triangles)
      for (const std::uint32_t t : triangles) pairs.insert({s, t});
  expect_so_many_as_wanted(wave, wave, pairs.size());
}

void expect_all_of_a_sheet_on_a_floor(const Mesh& floor, const Mesh& sheet) {
  std::size_t expected = 0;
  for (std::uint32_t t = 0; t < sheet.triangles.size(); ++t) {
    const Corners q = corners_at(sheet, t, {});
    const auto [low, high] = std::minmax({q[0].z, q[1].z, q[2].z});
    for (std::uint32_t s = 0; low <= 0 && high >= 0 && s < floor.triangles.size(); ++s)
      expected += triangles_intersect(corners_at(floor, s, {}), q);
  }
  EXPECT_GT(expected, 8u);
  expect_so_many_as_wanted(floor, sheet, expected);
}

TEST(Contacts, AreFoundAmongManyThatNearlyTouch) {
  constexpr int kCells = 80;
  const Mesh floor = plate(kCells, 2, [](int, int) { return 0.0; });
  // All over the plates, rounding hides whether they touch; nearly all candidates of all packets do not.
  expect_all_of_a_sheet_on_a_floor(floor, plate(kCells, 2, [](int u, int v) { return u + v < 4 ? -0.01 : 1e-9; }));
  // Some branches of the tree have many packets that touch, some few, and some none.
  expect_all_of_a_sheet_on_a_floor(
      floor, plate(kCells, 2, [](int u, int v) { return std::sin(0.4 * u) * std::sin(0.3 * v) + 0.01 * u - 0.2; }));
}

// A floor and a plate on it: the contacts reported come from all over the plate.
TEST(Contacts, AreSpreadOverTheArea) {
  const Body floor(plate(80, 2, [](int, int) { return 0.0; })),
      sheet(plate(60, 1, [](int u, int v) { return (u + v) % 2 ? 0.01 : -0.01; }));
  const ContactResult found = contacts(floor, {}, sheet, {}, {.most = 64});
  EXPECT_TRUE(found.overflow);
  ASSERT_EQ(found.contacts.size(), 64u);
  int in_cell[16] = {};
  for (const ContactPoint& c : found.contacts)
    ++in_cell[std::clamp(int((c.point.x + 0.5) * 4), 0, 3) + 4 * std::clamp(int((c.point.y + 0.5) * 4), 0, 3)];
  for (int cell = 0; cell < 16; ++cell) EXPECT_GE(in_cell[cell], 1) << "cell " << cell;
}

}  // namespace
}  // namespace standoff
