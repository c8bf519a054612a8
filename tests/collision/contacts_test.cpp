// Contacts against every pair of triangles.
#include <gtest/gtest.h>

#include <set>

#include "difi/collision.h"
#include "tests/collision/bodies.h"

namespace difi {
namespace {

using namespace difi::testing;
using Pairs = std::set<std::pair<std::uint32_t, std::uint32_t>>;

Pairs brute_pairs(const Mesh& a, const Pose& pose_a, const Mesh& b, const Pose& pose_b, double margin) {
  Pairs pairs;
  for (std::uint32_t s = 0; s < a.triangles.size(); ++s)
    for (std::uint32_t t = 0; t < b.triangles.size(); ++t) {
      const Corners p = corners_at(a, s, pose_a), q = corners_at(b, t, pose_b);
      if (triangles_touch(p, q) || (margin > 0 && closest_points(p, q).distance_sq <= margin * margin))
        pairs.insert({s, t});
    }
  return pairs;
}

void expect_as_brute_force(const Mesh& a, const Mesh& b, int poses, double half, double margin, unsigned seed) {
  const CollisionModel model_a(a), model_b(b);
  Random random(seed);
  std::size_t touching = 0;
  for (int n = 0; n < poses; ++n) {
    SCOPED_TRACE("pose " + std::to_string(n));
    const Pose pose_a = n % 2 ? Pose{} : random_pose(random, half), pose_b = random_pose(random, half);
    const Pairs expected = brute_pairs(a, pose_a, b, pose_b, margin);
    touching += !expected.empty();
    const Contacts all = contacts(model_a, pose_a, model_b, pose_b, {.most = 1'000'000, .margin = margin});
    EXPECT_FALSE(all.overflow);
    Pairs found;
    for (const ContactPoint& c : all.contacts) {
      found.insert({c.triangle_a, c.triangle_b});
      ASSERT_NEAR(length(c.normal), 1, 1e-9);
      // Moved along the normal by its depth, the pair is apart.
      Pose out = pose_b;
      out.translation = out.translation + c.normal * (c.depth + 1e-9);
      const bool still = triangles_touch(corners_at(a, c.triangle_a, pose_a), corners_at(b, c.triangle_b, out));
      EXPECT_FALSE(c.depth >= 0 && still);
    }
    EXPECT_EQ(found, expected);
    EXPECT_EQ(found.size(), all.contacts.size());
    if (expected.size() < 2) continue;
    const auto half_of_them = static_cast<std::int64_t>(expected.size() / 2);
    const Contacts some = contacts(model_a, pose_a, model_b, pose_b, {.most = half_of_them, .margin = margin});
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
  expect_as_brute_force(ball_mesh(1, 5), ball_mesh(0.5, 4), 100, 1, 0, 1);
  expect_as_brute_force(ball_mesh(0.5, 4), ball_mesh(1, 5), 100, 1, 0, 2);
  expect_as_brute_force(random_soup(3, 60, 1, 0.5), random_soup(4, 60, 1, 0.5), 50, 1, 0, 3);
}

TEST(Contacts, AreAllPairsWithinTheMargin) { expect_as_brute_force(ball_mesh(1, 3), ball_mesh(0.5, 3), 50, 1, 0.1, 4); }

// A floor and a plate on it: the contacts reported come from all over the plate.
TEST(Contacts, AreSpreadOverTheArea) {
  const auto plate = [](int cells, double side, double tilt) {
    Mesh mesh;
    for (int i = 0; i < cells; ++i)
      for (int j = 0; j < cells; ++j) {
        const auto at = [&](int u, int v) {
          const double s = side / cells;
          return Vec3{u * s - side / 2, v * s - side / 2, (u + v) % 2 ? tilt : -tilt};
        };
        add_triangle(mesh, at(i, j), at(i + 1, j), at(i, j + 1));
        add_triangle(mesh, at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
      }
    return mesh;
  };
  const CollisionModel floor(plate(80, 2, 0)), sheet(plate(60, 1, 0.01));
  const Contacts found = contacts(floor, {}, sheet, {}, {.most = 64});
  EXPECT_TRUE(found.overflow);
  ASSERT_EQ(found.contacts.size(), 64u);
  int in_cell[16] = {};
  for (const ContactPoint& c : found.contacts)
    ++in_cell[std::clamp(int((c.point.x + 0.5) * 4), 0, 3) + 4 * std::clamp(int((c.point.y + 0.5) * 4), 0, 3)];
  for (int cell = 0; cell < 16; ++cell) EXPECT_GE(in_cell[cell], 1) << "cell " << cell;
}

}  // namespace
}  // namespace difi
