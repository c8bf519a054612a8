// SPDX-License-Identifier: Apache-2.0
// Which parts contain which: known depths, and boxes compared with all other boxes.
#include "sign/diagnosis/nesting.h"

#include <gtest/gtest.h>

#include "tests/sign/shapes.h"

namespace standoff {
namespace {

using namespace testing;

// A mesh of boxes, each a part.
struct Boxes {
  Mesh mesh;
  std::vector<std::uint32_t> part_of;
  std::vector<Part> parts;

  void add(const Box& bounds, bool turned = false) {
    const Mesh one = turned ? reversed(box(bounds.min, bounds.max)) : box(bounds.min, bounds.max);
    append(mesh, one);
    part_of.insert(part_of.end(), one.triangles.size(), static_cast<std::uint32_t>(parts.size()));
    parts.push_back({bounds, true});
  }
  Nesting nesting(std::int64_t most = kMostNestingTests) const { return find_nesting({mesh}, part_of, parts, most); }
};

Box cube(double half, Vec3 center = {}) {
  const Vec3 h{half, half, half};
  return {center - h, center + h};
}

TEST(Nesting, ThousandsOfNestedShells) {
  constexpr int kShells = 4001;
  Boxes boxes;
  for (int n = 0; n < kShells; ++n) boxes.add(cube(1 + (n * 7) % kShells), n % 3 == 0);  // not in the order of size
  const Nesting found = boxes.nesting();
  ASSERT_TRUE(found.known);
  std::int64_t wrong = 0;
  for (std::uint32_t n = 0; n < kShells; ++n) {
    const int depth = kShells - 1 - (static_cast<int>(n) * 7) % kShells;
    wrong += found.depth[n] != depth;
    wrong += (found.parent[n] == Nesting::kNone) != (depth == 0);
    if (depth > 0) wrong += found.depth[found.parent[n]] != depth - 1;
  }
  EXPECT_EQ(wrong, 0);
}

TEST(Nesting, BoxesInBoxesAreComparedWithAllOthers) {
  Random random(5);
  Boxes boxes;
  for (int n = 0; n < 400; ++n) boxes.add(cube(random.between(0.01, 1), random.in_cube(2)), random.below(2) == 0);
  const Nesting found = boxes.nesting();
  for (std::size_t n = 0; n < boxes.parts.size(); ++n) {
    int depth = 0;
    for (const Part& other : boxes.parts) {
      const Box &a = other.bounds, &b = boxes.parts[n].bounds;
      depth += a.min.x < b.min.x && a.min.y < b.min.y && a.min.z < b.min.z && a.max.x > b.max.x && a.max.y > b.max.y &&
               a.max.z > b.max.z;
    }
    EXPECT_EQ(found.depth[n], depth);
  }
}

// Balls in balls at random places: trees of many branches, with several children on each row.
TEST(Nesting, TreesOfBalls) {
  Random random(11);
  Mesh mesh;
  std::vector<std::uint32_t> part_of;
  std::vector<Part> parts;
  std::vector<std::int32_t> depths;
  std::vector<std::uint32_t> parents;
  const auto add = [&](const auto& again, Vec3 center, double radius, std::uint32_t parent, int depth) -> void {
    const auto number = static_cast<std::uint32_t>(parts.size());
    const Mesh ball = moved(sphere(5), center, radius), one = random.below(2) == 0 ? ball : reversed(ball);
    mesh = joined(std::move(mesh), one);
    part_of.insert(part_of.end(), one.triangles.size(), number);
    parts.push_back({bounds(one), true});
    depths.push_back(depth);
    parents.push_back(parent);
    if (depth == 6) return;
    // Four children beside each other, or one, or none.
    const std::uint32_t kind = random.below(6);
    if (kind == 0 && depth > 1) return;
    for (int n = 0; n < (kind < 4 ? 1 : 4); ++n) {
      const Vec3 at = kind < 4 ? Vec3{} : Vec3{n & 1 ? 0.35 : -0.35, n & 2 ? 0.35 : -0.35, 0.1 * n - 0.15};
      again(again, center + (at + random.in_cube(0.02)) * radius, radius * (kind < 4 ? 0.8 : 0.3), number, depth + 1);
    }
  };
  for (int n = 0; n < 12; ++n) add(add, {2.5 * (n % 4), 2.2 * (n / 4), 0}, 1, Nesting::kNone, 0);
  const Nesting found = find_nesting({mesh}, part_of, parts);
  EXPECT_EQ(found.depth, depths);
  EXPECT_EQ(found.parent, parents);
  EXPECT_GT(parts.size(), 200u);
}

TEST(Nesting, ABoxAroundIsNotEnough) {
  // Balls in the hole of a torus, in its tube, and beside the tube, where a ray passes through it.
  const Mesh ring = torus(), hole = moved(sphere(), {}, 0.2), tube = moved(sphere(), {0, 1, 0}, 0.1),
             beside = moved(sphere(), {-0.24, 0, 1.28}, 0.01);
  const Mesh mesh = joined(joined(joined(ring, hole), tube), beside);
  std::vector<std::uint32_t> part_of(ring.triangles.size(), 0);
  for (const std::uint32_t part : {1, 2, 3}) part_of.insert(part_of.end(), hole.triangles.size(), part);
  const std::vector<Part> parts = {
      {bounds(ring), true}, {bounds(hole), true}, {bounds(tube), true}, {bounds(beside), true}};
  EXPECT_EQ(find_nesting({mesh}, part_of, parts).depth, (std::vector<std::int32_t>{0, 0, 1, 0}));
}

TEST(Nesting, PartsThatTouchFromInside) {
  Boxes boxes;
  boxes.add(cube(1));
  boxes.add({{-1, -1, -1}, {0, 0, 0}});
  boxes.add({{0, 0, 0}, {1, 1, 1}});
  boxes.add({{1, -1, -1}, {2, 1, 1}});  // beside it
  EXPECT_EQ(boxes.nesting().depth, (std::vector<std::int32_t>{0, 1, 1, 0}));
}

TEST(Nesting, IsNotKnownIfItTakesTooLong) {
  Boxes boxes;
  for (int n = 0; n < 50; ++n) boxes.add(cube(1 + n));
  EXPECT_TRUE(boxes.nesting().known);
  const Nesting found = boxes.nesting(100);
  EXPECT_FALSE(found.known);
  EXPECT_EQ(found.depth, std::vector<std::int32_t>(50));
}

TEST(Nesting, OnlySolidPartsCount) {
  Boxes boxes;
  for (int n = 0; n < 4; ++n) boxes.add(cube(4 - n));
  boxes.parts[1].solid = false;
  EXPECT_EQ(boxes.nesting().depth, (std::vector<std::int32_t>{0, 0, 1, 2}));
}

}  // namespace
}  // namespace standoff
