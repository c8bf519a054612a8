// SPDX-License-Identifier: Apache-2.0
#include "sign/diagnosis/closed.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "scenes/scenes.h"
#include "standoff/compute.h"
#include "standoff/mesh_report.h"
#include "tests/sign/shapes.h"
#include "tests/sign/solid_soup.h"

namespace standoff {
namespace {

using testing::box;
using testing::joined;
using testing::moved;
using testing::Random;
using testing::reversed;
using testing::sphere;

// Closed meshes are recognised, however they are stored; meshes that lack or turn a single triangle are not.

struct Expected {
  bool oriented, unoriented;
};
void expect_closed(const Mesh& mesh, Expected expected, const char* what) {
  const Closed welded = is_closed(mesh);
  EXPECT_EQ(welded.oriented, expected.oriented) << what;
  EXPECT_EQ(welded.unoriented, expected.unoriented) << what;
  // Three vertices for each triangle, and 0 as -0.
  Mesh loose;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    auto [a, b, c] = MeshView(mesh).corners(t);
    if (t % 2 == 0)
      for (Vec3* v : {&a, &b, &c}) *v = {v->x == 0 ? -0.0 : v->x, v->y == 0 ? -0.0 : v->y, v->z == 0 ? -0.0 : v->z};
    testing::add_triangle(loose, a, b, c);
  }
  const Closed apart = is_closed(loose);
  EXPECT_EQ(apart.oriented, expected.oriented) << what << ", not welded";
  EXPECT_EQ(apart.unoriented, expected.unoriented) << what << ", not welded";
}

Mesh closed_solids() {
  Random random(1);
  return testing::mesh_of(testing::integer_tetrahedra(random, 40, 2));
}

TEST(Closed, SolidsAndScenes) {
  expect_closed(closed_solids(), {true, true}, "tetrahedra of few corners");
  expect_closed(scenes::make("catapult", 3000), {true, true}, "catapult");
}

TEST(Closed, EveryTriangleCounts) {
  Random random(2);
  const Mesh whole = testing::mesh_of(testing::integer_tetrahedra(random, 6, 50));
  for (std::size_t t = 0; t < whole.triangles.size(); ++t) {
    Mesh missing = whole, turned = whole, twice = whole;
    missing.triangles.erase(missing.triangles.begin() + static_cast<std::ptrdiff_t>(t));
    std::swap(turned.triangles[t][0], turned.triangles[t][1]);
    twice.triangles.push_back(whole.triangles[t]);
    expect_closed(missing, {false, false}, "one is missing");
    expect_closed(turned, {false, true}, "one is turned");
    expect_closed(twice, {false, false}, "one is there twice");
  }
}

// Holes that cancel each other in sums of areas, normals or positions.
TEST(Closed, SymmetricHoles) {
  Mesh grid;
  constexpr std::uint32_t kSide = 6;
  for (std::uint32_t y = 0; y < kSide; ++y)
    for (std::uint32_t x = 0; x < kSide; ++x) grid.vertices.push_back({double(x), double(y), 0});
  for (const bool up : {true, false})
    for (std::uint32_t y = 0; y + 1 < kSide; ++y)
      for (std::uint32_t x = 0; x + 1 < kSide; ++x) {
        const std::uint32_t a = x + kSide * y, b = a + 1, c = a + kSide, d = c + 1;
        for (const Triangle& t : {Triangle{a, b, d}, Triangle{a, d, c}})
          grid.triangles.push_back(up ? t : Triangle{t[0], t[2], t[1]});
      }
  expect_closed(grid, {true, true}, "two sheets");
  const std::size_t half = grid.triangles.size() / 2;
  Mesh holes = grid;
  holes.triangles.erase(holes.triangles.begin() + static_cast<std::ptrdiff_t>(half) + 20);
  holes.triangles.erase(holes.triangles.begin() + 4);
  expect_closed(holes, {false, false}, "congruent holes, one in each sheet");
  Mesh once = grid;
  once.triangles.erase(once.triangles.begin() + static_cast<std::ptrdiff_t>(half) + 4);
  once.triangles.erase(once.triangles.begin() + 4);
  expect_closed(once, {true, true}, "the same triangle of both");
}

TEST(Closed, DegenerateTrianglesAndDuplicates) {
  Mesh mesh = closed_solids();
  const Vec3 a{0.5, 0, 0}, b{1, 2, 3};
  testing::add_triangle(mesh, a, a, a);
  testing::add_triangle(mesh, a, b, b);
  expect_closed(mesh, {true, true}, "a point, and a segment there and back");
  for (const Triangle t : std::vector<Triangle>(mesh.triangles)) mesh.triangles.push_back(t);
  expect_closed(mesh, {true, true}, "all twice");
  Mesh many{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, std::vector<Triangle>(4096, Triangle{0, 1, 2})};
  expect_closed(many, {false, true}, "one triangle 4096 times");
}

// Which meshes need no diagnosis: closed ones whose parts all have a positive volume.

Mesh flat(Mesh mesh) {
  for (Vec3& v : mesh.vertices) v.z = 0;
  return mesh;
}

TEST(Outward, AllPartsMustFaceOutwards) {
  EXPECT_TRUE(faces_outwards(box()));
  EXPECT_TRUE(faces_outwards(joined(box(), moved(sphere(), {1e6, 0, 0}, 1e-3))));
  EXPECT_FALSE(faces_outwards(reversed(box())));
  EXPECT_FALSE(faces_outwards(joined(box(), reversed(moved(sphere(), {1e6, 0, 0}, 1e-3)))));
  Mesh unused = box();
  unused.vertices.push_back({5, 5, 5});
  EXPECT_TRUE(faces_outwards(unused));
}

// Parts are found whatever the order of triangles: neither torn apart nor taken for one.
TEST(Outward, PartsInAnyOrder) {
  const Mesh small = moved(sphere(), {0.2, 0.1, 0}, 1e-3);
  for (unsigned seed = 0; seed < 20; ++seed) {
    EXPECT_TRUE(faces_outwards(testing::shuffled(joined(sphere(), small), seed)));
    EXPECT_FALSE(faces_outwards(testing::shuffled(joined(sphere(), reversed(small)), seed)));
  }
}

// Closed, all of them, and without an inside: what compute() takes by itself is what the report recommends.
TEST(Outward, ClosedMeshesWithoutAVolumeAreDiagnosed) {
  Mesh both{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 1}}};
  const Mesh point{{{0, 0, 0}}, {{0, 0, 0}}};
  const Grid grid{{6, 6, 6}, {-1, -1, -1}, {0.5, 0.5, 0.5}};
  for (const Mesh& mesh : {both, point, flat(box())}) {
    EXPECT_FALSE(faces_outwards(mesh));
    const SignReport used = compute(mesh, grid, 1, {.sign = {SignMethod::automatic}}).report.sign;
    const MeshReport found = report(mesh);
    EXPECT_EQ(used.method, found.method) << used.why;
    EXPECT_EQ(used.sure, found.sure) << used.why;
  }
}

// Sums that follow a mesh say what the passes say, and exactly nothing stays behind of what moved.

std::vector<std::uint32_t> all_triangles(const Mesh& mesh) {
  std::vector<std::uint32_t> all(mesh.triangles.size());
  std::iota(all.begin(), all.end(), 0u);
  return all;
}

TEST(Closed, SumsCanBeTakenOutAgain) {
  Mesh mesh = closed_solids();
  const Mesh before = mesh;
  EdgeSums sums{mesh};
  EXPECT_TRUE(sums.closed().oriented && sums.closed().unoriented);
  const std::vector<std::uint32_t> one{5};
  mesh.vertices.push_back({100, 200, 300});
  mesh.triangles[5][1] = static_cast<std::uint32_t>(mesh.vertices.size() - 1);
  sums -= EdgeSums(before, one);
  EXPECT_FALSE(sums.closed().unoriented);
  sums += EdgeSums(mesh, one);
  EXPECT_EQ(sums.closed().unoriented, is_closed(mesh).unoriented);
  EXPECT_FALSE(sums.closed().oriented);
  sums -= EdgeSums(mesh, one);
  sums += EdgeSums(before, one);
  EXPECT_TRUE(sums.closed().oriented && sums.closed().unoriented);
}

TEST(Outward, SumsFollow) {
  Mesh mesh = joined(box(), moved(sphere(), {1e3, 0, 0}, 1e-3));
  const Mesh before = mesh;
  const auto box_vertices = box().vertices.size();
  OutwardSums sums(mesh);
  EXPECT_TRUE(sums.surely_outwards());
  const std::vector<std::uint32_t> all = all_triangles(mesh);
  const auto become = [&](const Mesh& now) {
    sums.follow(mesh, now, all);
    mesh = now;
  };
  Random random(3);
  for (int n = 0; n < 1000; ++n) {
    Mesh now = before;
    const Vec3 by_that{random.below(100) * 0.37, random.below(100) * 1e-7, 0};
    for (Vec3& v : now.vertices) v = v + by_that;
    // Whatever they are then, they are sure of nothing that is not so.
    if (n % 3 == 0)
      for (std::size_t v = box_vertices; v < now.vertices.size(); ++v) now.vertices[v].z *= -1;
    become(now);
    if (sums.surely_outwards()) {
      EXPECT_TRUE(faces_outwards(mesh));
    }
  }
  Mesh turned = before;
  for (std::size_t v = box_vertices; v < turned.vertices.size(); ++v) turned.vertices[v].z *= -1;
  become(turned);
  EXPECT_FALSE(faces_outwards(mesh));
  EXPECT_FALSE(sums.surely_outwards());
  become(before);
  EXPECT_TRUE(sums.surely_outwards());
  become(flat(before));
  EXPECT_FALSE(sums.surely_outwards());
  Mesh huge = before;
  for (Vec3& v : huge.vertices) v = v * 1e6;
  become(huge);  // terms too large for their units
  EXPECT_TRUE(!sums.surely_outwards() || faces_outwards(huge));
}

// A triangle so small beside what the units were chosen for that it counts as nothing: the normals do not cancel, but
// their integers do.
TEST(Outward, SumsKnowWhatTheyRoundedDown) {
  Mesh before = box();
  const Vec3 corner = before.vertices[0];
  before.vertices.insert(before.vertices.end(), 2, corner);
  before.triangles.push_back({0, 8, 9});
  Mesh after = before;
  for (Vec3& v : after.vertices) v = corner + (v - corner) * 0x1p-22;
  after.vertices[8].x += 2.3e-12;
  after.vertices[9].y += 2.3e-12;
  OutwardSums sums(before);
  EXPECT_TRUE(sums.surely_outwards());
  sums.follow(before, after, all_triangles(before));
  EXPECT_FALSE(faces_outwards(after));
  EXPECT_FALSE(sums.surely_outwards());
}

TEST(Outward, SumsOfOtherMeshes) {
  EXPECT_FALSE(OutwardSums(reversed(box())).surely_outwards());
  EXPECT_FALSE(OutwardSums(joined(box(), reversed(moved(sphere(), {1e6, 0, 0}, 1e-3)))).surely_outwards());
  EXPECT_FALSE(OutwardSums(flat(box())).surely_outwards());
  EXPECT_FALSE(OutwardSums(Mesh{{{0, 0, 0}}, {{0, 0, 0}}}).surely_outwards());
  EXPECT_TRUE(OutwardSums(scenes::make("catapult", 3000)).surely_outwards() ||
              !faces_outwards(scenes::make("catapult", 3000)));
  Mesh unused = box();
  unused.vertices.push_back({5, 5, 5});
  EXPECT_TRUE(OutwardSums(unused).surely_outwards());
}

}  // namespace
}  // namespace standoff
