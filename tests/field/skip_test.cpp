// SPDX-License-Identifier: Apache-2.0
// labels: memory threads

#include "field/skip.h"
#include "core/threads.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "tests/support/fields.h"
#include "tests/support/random_mesh.h"
#include "tests/support/sanitized.h"
#include "thesis/thesis.h"

namespace standoff::testing {
namespace {

using Kept = std::vector<std::uint32_t>;

const Grid kSkipGrid{{17, 17, 17}, {-4, -4, -4}, {0.5, 0.5, 0.5}};

Box triangle_box(MeshView mesh, std::uint32_t triangle) {
  Box box;
  for (int k = 0; k < 3; ++k) box.include(mesh.corner(triangle, k));
  return box;
}

bool is_inside(const Box& inner, const Box& outer) {
  return min(inner.min, outer.min) == outer.min && max(inner.max, outer.max) == outer.max;
}

// A triangle whose box is the cube of the given half-width around (x, 0, 0).
void add_cube(Mesh& mesh, double x, double half) {
  add_triangle(mesh, {x - half, -half, -half}, {x + half, half, -half}, {x, 0, half});
}

Mesh cubes(std::initializer_list<double> halves) {
  Mesh mesh;
  for (const double half : halves) add_cube(mesh, 0, half);
  return mesh;
}

TEST(KeptTriangles, NoneAndAutomaticKeepAll) {
  const Mesh mesh = nasty_soup(1, 30, 4);
  for (const auto kind : {SkipRule::Kind::none, SkipRule::Kind::automatic}) {
    const Kept kept = kept_triangles(mesh, kSkipGrid, 1, {kind, 1});
    ASSERT_EQ(kept.size(), mesh.triangles.size());
    for (std::uint32_t t = 0; t < kept.size(); ++t) EXPECT_EQ(kept[t], t);
  }
}

TEST(NeighbourRule, DropsBoxesInsideANeighbour) {
  EXPECT_EQ(kept_by_neighbour_rule(cubes({2, 1}), 1, 1), (Kept{0}));
  EXPECT_EQ(kept_by_neighbour_rule(cubes({1, 2}), 1, 1), (Kept{1}));
  EXPECT_EQ(kept_by_neighbour_rule(cubes({1, 3, 2}), 1, 1), (Kept{1}));
}

TEST(NeighbourRule, GoesOnUntilNothingMoreCanBeDropped) {
  EXPECT_EQ(kept_by_neighbour_rule(cubes({1, 2, 3, 4}), 1, 1), (Kept{3}));
  EXPECT_EQ(kept_by_neighbour_rule(cubes({4, 3, 2, 1}), 1, 1), (Kept{0}));
  // The second triangle is dropped for the third, which makes the first a neighbour of the third.
  Mesh mesh;
  add_cube(mesh, 1, 1);
  add_cube(mesh, -1, 1);
  add_cube(mesh, 0, 3);
  EXPECT_EQ(kept_by_neighbour_rule(mesh, 1, 1), (Kept{2}));
}

TEST(NeighbourRule, ComparesNeighboursOnly) {
  Mesh mesh;
  add_cube(mesh, 0, 2);
  add_cube(mesh, 10, 1);
  add_cube(mesh, 0, 1);
  EXPECT_EQ(kept_by_neighbour_rule(mesh, 1, 1), (Kept{0, 1, 2}));
}

TEST(NeighbourRule, KeepsTheFirstOfEqualBoxes) {
  EXPECT_EQ(kept_by_neighbour_rule(cubes({1, 1, 1, 1}), 1, 1), (Kept{0}));
  EXPECT_EQ(kept_by_neighbour_rule(cubes({1}), 1, 1), (Kept{0}));
}

TEST(NeighbourRule, LeavesNoPairToDropAndCoversWhatItDrops) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const Mesh mesh = nasty_soup(seed, 200, 2);
    const Kept kept = kept_by_neighbour_rule(mesh, 1, 1);
    ASSERT_TRUE(std::ranges::is_sorted(kept));
    for (std::size_t n = 1; n < kept.size(); ++n) {
      const Box a = triangle_box(mesh, kept[n - 1]), b = triangle_box(mesh, kept[n]);
      ASSERT_FALSE(is_inside(a, b) || is_inside(b, a));
    }
    for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
      ASSERT_TRUE(std::ranges::any_of(
          kept, [&](std::uint32_t other) { return is_inside(triangle_box(mesh, t), triangle_box(mesh, other)); }));
  }
}

TEST(NeighbourRule, DoesNotDependOnThicknessAtFractionOne) {
  const Mesh mesh = nasty_soup(3, 300, 2);
  const Kept kept = kept_by_neighbour_rule(mesh, 1, 1);
  for (const double thickness : {1e-12, 0.1, 3.0, 1e6, 1e18, kInfinity})
    EXPECT_EQ(kept_by_neighbour_rule(mesh, thickness, 1), kept);
}

TEST(NeighbourRule, DropsMoreAtSmallerFractions) {
  const Mesh mesh = random_soup(4, 2000, 2, 1);
  std::size_t before = kept_by_neighbour_rule(mesh, 1, 1).size();
  for (const double fraction : {0.9, 0.75, 0.5, 0.25, 0.01}) {
    const std::size_t kept = kept_by_neighbour_rule(mesh, 1, fraction).size();
    EXPECT_LT(kept, before);
    before = kept;
  }
  EXPECT_GE(before, 1u);
}

// The rule says "at least" the fraction: exactly half of each box lies in the other.
TEST(NeighbourRule, TheFractionItselfIsEnough) {
  Mesh mesh;
  add_cube(mesh, 0, 1);
  add_cube(mesh, 1, 1);
  EXPECT_EQ(kept_by_neighbour_rule(mesh, kInfinity, 0.5), (Kept{0}));
  EXPECT_EQ(kept_by_neighbour_rule(mesh, kInfinity, 0.5000001), (Kept{0, 1}));
  EXPECT_EQ(kept_by_neighbour_rule(mesh, 1, 0.75), (Kept{0}));
  EXPECT_EQ(kept_by_neighbour_rule(mesh, 1, 0.7500001), (Kept{0, 1}));
}

TEST(ShareInside, IsTheShareOfTheGrownVolume) {
  const Box unit{{0, 0, 0}, {2, 2, 2}}, shifted{{1, 0, 0}, {3, 2, 2}}, flat{{0, 0, 1}, {2, 2, 1}};
  EXPECT_EQ(share_inside(unit, unit, 1), 1);
  EXPECT_EQ(share_inside(unit, shifted, 0), 0.5);
  EXPECT_EQ(share_inside(unit, shifted, 1), 0.75);
  EXPECT_EQ(share_inside(flat, unit, 0), 1);
  EXPECT_EQ(share_inside(unit, flat, 0), 0);
  EXPECT_EQ(share_inside(unit, flat, 1), 0.5);
  EXPECT_EQ(share_inside(unit, {{9, 0, 0}, {10, 2, 2}}, 1), 0);
  EXPECT_EQ(share_inside({{1, 0, 0}, {1, 2, 2}}, {{2, 0, 0}, {2, 2, 2}}, 0), 0);
}

TEST(ExactRule, DropsCopiesAndKeepsTheFirst) {
  Mesh mesh = random_soup(5, 3, 3, 1);
  mesh.triangles.insert(mesh.triangles.begin() + 1, mesh.triangles[0]);
  mesh.triangles.push_back(mesh.triangles[0]);
  // A copy with vertices of its own.
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (int k = 0; k < 3; ++k) mesh.vertices.push_back(mesh.vertices[mesh.triangles[2][k]]);
  mesh.triangles.push_back({first, first + 1, first + 2});
  EXPECT_EQ(kept_by_exact_rule(mesh, kSkipGrid, 1), (Kept{0, 2, 3}));
}

TEST(ExactRule, DropsTrianglesOutOfReachOfEverySample) {
  Mesh mesh;
  add_cube(mesh, 0, 1);
  add_cube(mesh, 6.5, 0.25);  // ends 2.25 beyond the last sample
  add_cube(mesh, -100, 1);
  EXPECT_EQ(kept_by_exact_rule(mesh, kSkipGrid, 2), (Kept{0}));
  EXPECT_EQ(kept_by_exact_rule(mesh, kSkipGrid, 2.25), (Kept{0, 1}));
  EXPECT_EQ(kept_by_exact_rule(mesh, kSkipGrid, kInfinity), (Kept{0, 1, 2}));
}

TEST(ExactRule, DropsTrianglesThatFallBetweenSamples) {
  Mesh mesh;
  add_cube(mesh, 0.25, 0.01);
  for (Vec3& v : mesh.vertices) v = v + Vec3{0, 0.25, 0.25};
  add_cube(mesh, 0, 0.01);
  EXPECT_EQ(kept_by_exact_rule(mesh, kSkipGrid, 0.1), (Kept{1}));
}

TEST(ExactRule, KeepsOneTriangleOfAMeshThatIsAllOutOfReach) {
  Mesh mesh;
  add_cube(mesh, 100, 1);
  add_cube(mesh, 200, 1);
  EXPECT_EQ(kept_by_exact_rule(mesh, kSkipGrid, 1), (Kept{0}));
}

TEST(ExactRule, TellsZeroFromMinusZero) {
  Mesh mesh;
  add_triangle(mesh, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  add_triangle(mesh, {-0.0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  EXPECT_EQ(kept_by_exact_rule(mesh, kSkipGrid, 1).size(), 2u);
}

TEST(ExactRule, FindsEveryCopyInALargeMeshOnAnyNumberOfThreads) {
  Random random(6);
  Mesh mesh = random_soup(6, 60000, 3.9, 0.1);
  std::set<std::uint32_t> copies;
  for (int n = 0; n < 30000; ++n) {
    copies.insert(static_cast<std::uint32_t>(mesh.triangles.size()));
    mesh.triangles.push_back(mesh.triangles[random.below(60000)]);
  }
  const SkipRule rule{SkipRule::Kind::exact, 1};
  const auto kept_with = [&](int threads) {
    return Threads(threads).run([&] { return kept_triangles(mesh, kSkipGrid, 1, rule); });
  };
  const Kept kept = kept_with(1);
  EXPECT_EQ(kept.size(), 60000u);
  for (const std::uint32_t t : kept) ASSERT_FALSE(copies.contains(t));
  for (int threads = 2; threads <= 8; ++threads) ASSERT_EQ(kept_with(threads), kept);
}

// Among this many triangles, some pairs have the same 32-bit hash by chance, but are no copies.
TEST(ExactRule, DifferentTrianglesOfOneHashStay) {
  const Mesh mesh = random_soup(8, 400000, 3.9, 0.1);
  EXPECT_EQ(kept_by_exact_rule(mesh, kSkipGrid, 1).size(), mesh.triangles.size());
}

ComputeResult computed(MeshView mesh, double thickness, Method method, SkipRule::Kind rule) {
  ComputeOptions options{.method = method, .skip = {.kind = rule}, .sign = {SignMethod::none}, .nearest = true};
  return compute(mesh, kSkipGrid, thickness, options);
}

TEST(ExactRule, ChangesNoBitOfTheFieldNorOfTheNearestTriangles) {
  Random random(7);
  for (unsigned seed = 0; seed < (kSanitized ? 2 : 6); ++seed) {
    Mesh mesh = seed % 2 == 0 ? nasty_soup(seed, 300, 8) : random_soup(seed, 300, 8, 0.7);
    for (int n = 0; n < 300; ++n) mesh.triangles.push_back(mesh.triangles[random.below(300)]);
    for (Triangle& t : mesh.triangles) std::swap(t, mesh.triangles[random.below(600)]);
    for (const Method method : {Method::tiles, Method::thesis})
      for (const double thickness : {0.4, 3.0, kInfinity}) {
        const ComputeResult all = computed(mesh, thickness, method, SkipRule::Kind::none);
        const ComputeResult some = computed(mesh, thickness, method, SkipRule::Kind::exact);
        EXPECT_EQ(all.report.skipped, 0);
        EXPECT_GT(some.report.skipped, 250);
        expect_same_bits(some.field, all.field);
      }
  }
}

TEST(ExactRule, SaysHowMuchMemoryItNeeds) {
  EXPECT_EQ(skip_bytes(1000, {SkipRule::Kind::neighbour, 1}), 4000);
  EXPECT_GT(skip_bytes(1000, {SkipRule::Kind::exact, 1}), 4000);
}

}  // namespace
}  // namespace standoff::testing
