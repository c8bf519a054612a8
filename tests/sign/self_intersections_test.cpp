// SPDX-License-Identifier: Apache-2.0
// Triangles that intersect: as many as all pairs have, and bounded effort.
#include "sign/diagnosis/self_intersections.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/threads.h"
#include "geometry/triangle_pair.h"
#include "standoff/error.h"
#include "tests/sign/shapes.h"

namespace standoff {
namespace {

using namespace testing;

constexpr std::int64_t kEveryPair = 1'000'000'000;

SelfIntersections find(const Mesh& mesh, std::int64_t most_pairs = kEveryPair, std::int64_t most_tests = kEveryPair) {
  ProgressMeter progress;
  return find_self_intersections(mesh, MeshEdges(mesh), {most_pairs, most_tests}, progress);
}

std::int64_t among_all_pairs(const Mesh& mesh) {
  std::int64_t count = 0;
  for (std::size_t s = 0; s < mesh.triangles.size(); ++s)
    for (std::size_t t = s + 1; t < mesh.triangles.size(); ++t) {
      const auto p = MeshView(mesh).corners(s), q = MeshView(mesh).corners(t);
      bool shared = false;
      for (const Vec3& corner : p) shared = shared || std::ranges::count(q, corner) > 0;
      count += !shared && triangles_intersect(p, q);
    }
  return count;
}

TEST(SelfIntersections, AreThoseOfAllPairs) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    for (const Mesh& mesh : {random_soup(seed, 80, 1, 0.5), nasty_soup(seed, 80, 2)}) {
      const SelfIntersections found = find(mesh);
      EXPECT_TRUE(found.complete);
      EXPECT_EQ(found.pairs, among_all_pairs(mesh));
    }
  }
  EXPECT_EQ(find(sphere()).pairs, 0);
  EXPECT_EQ(find(torus()).pairs, 0);
  const Mesh bottle = klein_bottle();
  EXPECT_GT(find(bottle).pairs, 24);
  EXPECT_EQ(find(bottle).pairs, among_all_pairs(bottle));
  const Mesh overlapping = joined(sphere(), moved(sphere(), {0.5, 0.1, 0.2}));
  EXPECT_GT(find(overlapping).pairs, 30);
  EXPECT_EQ(find(overlapping).pairs, among_all_pairs(overlapping));
}

TEST(SelfIntersections, SmallAndFlatMeshes) {
  Mesh one;
  add_triangle(one, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  EXPECT_EQ(find(one).pairs, 0);
  Mesh points;
  for (int n = 0; n < 9; ++n) add_triangle(points, {1, 2, 3}, {1, 2, 3}, {1, 2, 3});
  EXPECT_EQ(find(points).pairs, 0);  // they share a position
}

// Each copy, turned or not, intersects what the others do, and none of them: as in all pairs.
TEST(SelfIntersections, CopiesCountOneByOne) {
  testing::Random random(7);
  for (unsigned seed = 0; seed < 5; ++seed) {
    Mesh mesh = random_soup(seed, 40, 1, 0.5);
    for (int n = 0; n < 60; ++n) {
      Triangle copy = mesh.triangles[random.below(static_cast<std::uint32_t>(mesh.triangles.size()))];
      if (n % 2 == 0) std::swap(copy[0], copy[1]);
      if (n % 3 == 0) std::rotate(copy.begin(), copy.begin() + 1, copy.end());
      mesh.triangles.push_back(copy);
    }
    EXPECT_GT(find(mesh).pairs, 0);
    EXPECT_EQ(find(mesh).pairs, among_all_pairs(mesh));
  }
}

// A scene that places a part again and again where it is: one pair of triangles, a billion pairs of copies.
TEST(SelfIntersections, AreThoseOfOneWhereAllAreCopies) {
  constexpr std::int64_t kCopies = 30000;
  Mesh mesh;
  for (std::int64_t n = 0; n < kCopies; ++n) {
    add_triangle(mesh, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    add_triangle(mesh, {0.2, 0.2, -1}, {0.2, 0.2, 1}, {0.3, 0.2, 1});
  }
  // A limit of tests that one pair of triangles is within.
  const SelfIntersections found = find(mesh, std::numeric_limits<std::int64_t>::max(), 1);
  EXPECT_EQ(found.pairs, kCopies * kCopies);
  EXPECT_TRUE(found.complete);
}

// Pairs that share a position need no test, but a look: a vertex of very many triangles, an edge of as many.
TEST(SelfIntersections, TheSearchStopsAmongPairsThatShareAPosition) {
  const auto around = [](std::uint32_t triangles, bool an_edge) {
    Mesh mesh;
    mesh.vertices = {{0, 0, 0}, {0, 0, 1}};
    for (std::uint32_t n = 0; n < triangles; ++n) {
      const double angle = kTurn * n / triangles;
      mesh.vertices.push_back({std::cos(angle), std::sin(angle), 0.01 * (n % 7)});
      mesh.triangles.push_back({0, n + 2, an_edge ? 1 : (n + 1) % triangles + 2});
    }
    return mesh;
  };
  for (const bool an_edge : {false, true}) {
    const SelfIntersections few = find(around(300, an_edge), kEveryPair, 100),
                            many = find(around(12000, an_edge), kEveryPair, 1000);
    EXPECT_EQ(few.pairs, 0);
    EXPECT_TRUE(few.complete);
    EXPECT_EQ(many.pairs, 0);
    EXPECT_FALSE(many.complete);
  }
}

TEST(SelfIntersections, TheSearchCanBeStopped) {
  const Mesh mesh = random_soup(3, 6000, 1, 0.3);
  const MeshEdges edges(mesh);
  for (const int stop : {1, 3, 5}) {
    int reports = 0;
    const ProgressCallback callback = [&](const Progress&) { return ++reports < stop; };
    ProgressMeter progress(callback);
    EXPECT_THROW(Threads(1).run([&] {
      find_self_intersections(mesh, edges, {kEveryPair, kEveryPair}, progress);
    }),
                 Error);
    EXPECT_EQ(reports, stop);
  }
}

TEST(SelfIntersections, TheSearchStopsAtEachLimit) {
  const Mesh mesh = random_soup(3, 6000, 1, 0.3);
  const SelfIntersections all = find(mesh), few_pairs = find(mesh, 10), few_tests = find(mesh, kEveryPair, 10);
  EXPECT_TRUE(all.complete);
  for (const SelfIntersections& some : {few_pairs, few_tests}) {
    EXPECT_FALSE(some.complete);
    EXPECT_GE(some.pairs, 10);
    EXPECT_LT(some.pairs, all.pairs);
  }
  // A triangle whose box overlaps those of all others.
  Mesh fan = random_soup(3, 12000, 1, 0.001);
  add_triangle(fan, {-9, -9, -9}, {9, 9, 9}, {-9, 9, -9});
  std::swap(fan.triangles.front(), fan.triangles.back());
  EXPECT_FALSE(find(fan).complete);
}

TEST(SelfIntersections, DoNotDependOnTheThreads) {
  const Mesh mesh = random_soup(4, 3000, 1, 0.2);
  const SelfIntersections one = Threads(1).run([&] { return find(mesh, 1000); }),
                          three = Threads(3).run([&] { return find(mesh, 1000); });
  EXPECT_EQ(one.pairs, three.pairs);
  EXPECT_FALSE(one.complete);
}

}  // namespace
}  // namespace standoff
