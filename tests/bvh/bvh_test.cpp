// SPDX-License-Identifier: Apache-2.0
// labels: memory threads
// The orders and the hierarchy against all triangles, one by one.
#include "bvh/bvh.h"

#include <gtest/gtest.h>

#include <numeric>

#include "bvh/order.h"
#include "core/threads.h"
#include "geometry/triangle_box.h"
#include "tests/support/closest_of_all.h"
#include "tests/support/random_mesh.h"

namespace standoff::testing {
namespace {

constexpr int kSizes[] = {1, 2, 15, 16, 17, 255, 256, 257, 300, 4097};

enum class Order { morton, halving };

std::vector<std::uint32_t> order_of(MeshView mesh, Order order, std::span<const std::uint32_t> among = {}) {
  ProgressMeter unwatched;
  return order == Order::morton ? morton_order(mesh, among, unwatched) : halving_order(mesh, among, unwatched);
}

Bvh bvh_of(MeshView mesh, Order order) {
  ProgressMeter unwatched;
  return {mesh, order_of(mesh, order), frame_around(mesh), unwatched};
}

bool overlap(const Box& a, const Box& b) {
  for (int axis = 0; axis < 3; ++axis)
    if (a.min[axis] > b.max[axis] || b.min[axis] > a.max[axis]) return false;
  return true;
}

TEST(Order, IsAPermutationOfTheTrianglesThatAreAskedFor) {
  for (const int triangles : kSizes) {
    const Mesh mesh = random_soup(1, triangles, 1, 0.1);
    std::vector<std::uint32_t> odd;
    for (std::uint32_t t = 1; t < mesh.triangles.size(); t += 2) odd.push_back(t);
    for (const Order kind : {Order::morton, Order::halving})
      for (const bool all : {true, false}) {
        if (!all && odd.empty()) continue;
        std::vector<std::uint32_t> order = order_of(mesh, kind, all ? std::span<const std::uint32_t>() : odd);
        std::ranges::sort(order);
        std::vector<std::uint32_t> every(mesh.triangles.size());
        std::iota(every.begin(), every.end(), 0u);
        EXPECT_EQ(order, all ? every : odd);
      }
  }
}

TEST(Order, DoesNotDependOnThreads) {
  const Mesh mesh = random_soup(2, 40000, 1, 0.01);
  for (const Order kind : {Order::morton, Order::halving}) {
    std::vector<std::uint32_t> of_one, of_four;
    Threads(1).run([&] { of_one = order_of(mesh, kind); });
    Threads(4).run([&] { of_four = order_of(mesh, kind); });
    EXPECT_EQ(of_one, of_four);
  }
}

TEST(Order, AStrayTriangleFarAwayChangesNoOrder) {
  // All others lie in one cell of its curve, or in two.
  Mesh mesh = random_soup(6, 20000, 1, 0.01);
  const std::vector<std::uint32_t> alone = order_of(mesh, Order::morton);
  for (const double away : {1e5, 1e9}) {
    Mesh both = mesh;
    add_triangle(both, {away, away, away}, {away, away + 1, away}, {away, away, away + 1});
    std::vector<std::uint32_t> order = order_of(both, Order::morton);
    EXPECT_EQ(order.back(), 20000u);
    order.pop_back();
    EXPECT_EQ(order, alone) << away;
  }
}

TEST(Order, OfOnePlaceIsByIndex) {
  const Mesh mesh = random_soup(3, 100, 0, 0);
  const std::vector<std::uint32_t> order = order_of(mesh, Order::morton);
  EXPECT_TRUE(std::ranges::is_sorted(order));
}

TEST(Order, TakesCoordinatesAtTheEndsOfDouble) {
  for (const double size : {1e308, 5e-324, 1e-300}) {
    Mesh mesh = random_soup(4, 50, 1, 0.5);
    for (Vec3& v : mesh.vertices) v = v * size;
    EXPECT_EQ(order_of(mesh, Order::morton).size(), 50u);
    EXPECT_EQ(order_of(mesh, Order::halving).size(), 50u);
    const BvhFrame frame = frame_around(mesh);
    for (const Vec3& v : mesh.vertices) EXPECT_LE(max_norm(frame.local(v)), 2.001) << size;
  }
}

TEST(RadixSort, IsStable) {
  Random random(5);
  std::vector<KeyedIndex> items;
  for (std::uint32_t n = 0; n < 50000; ++n)
    items.push_back({static_cast<std::uint32_t>(random.in_cube(1).x * 1e9 + 2e9) >> (n % 3 ? 24 : 0), n});
  std::vector<KeyedIndex> expected = items;
  std::ranges::stable_sort(expected, {}, &KeyedIndex::key);
  radix_sort(items, 3);
  for (std::size_t n = 0; n < items.size(); ++n) {
    ASSERT_EQ(items[n].key, expected[n].key);
    ASSERT_EQ(items[n].index, expected[n].index);
  }
}

TEST(Bvh, EveryNodeHoldsItsChildren) {
  for (const int triangles : kSizes) {
    const Mesh mesh = random_soup(6, triangles, 1, 0.2);
    const Bvh bvh = bvh_of(mesh, Order::halving);
    EXPECT_EQ(bvh.entries(), Bvh::entries_of(triangles));
    std::vector<int> seen(static_cast<std::size_t>(bvh.entries()));
    for (std::uint32_t entry = bvh.triangles(); entry < bvh.entries(); ++entry) {
      const BvhNode node = bvh.node(entry);
      for (int n = 0; n < node.count; ++n) {
        const std::uint32_t child = node.first + static_cast<std::uint32_t>(n);
        ++seen[child];
        const FloatBox box = lane_of(*node.boxes, n);
        if (!bvh.is_node(child)) {
          const Box own = triangle_box(mesh, bvh.order()[child]);
          const Vec3 low = bvh.frame().local(own.min), high = bvh.frame().local(own.max);
          for (int axis = 0; axis < 3; ++axis) {
            EXPECT_LT(box.low[axis], low[axis]);
            EXPECT_GT(box.high[axis], high[axis]);
          }
          continue;
        }
        const BvhNode inner = bvh.node(child);
        for (int k = 0; k < inner.count; ++k)
          for (int axis = 0; axis < 3; ++axis) {
            EXPECT_LE(box.low[axis], inner.boxes->low[axis][k]);
            EXPECT_GE(box.high[axis], inner.boxes->high[axis][k]);
          }
      }
      for (int n = node.count; n < Bvh::kFanout; ++n)
        EXPECT_GT(node.boxes->low[0][n], node.boxes->high[0][n]) << "a lane without a child";
    }
    for (std::uint32_t entry = 0; entry < bvh.root(); ++entry) EXPECT_EQ(seen[entry], 1);
    EXPECT_EQ(seen[bvh.root()], 0);
  }
}

TEST(Bvh, FindsTheTrianglesWhoseBoxesMeetABox) {
  for (const int triangles : kSizes)
    for (const Order kind : {Order::morton, Order::halving}) {
      const Mesh mesh = random_soup(7, triangles, 1, 0.3);
      const Bvh bvh = bvh_of(mesh, kind);
      Random random(8);
      for (int n = 0; n < 20; ++n) {
        const Vec3 p = random.in_cube(1.2), q = random.in_cube(1.2);
        const Box box = n % 4 == 0 ? Box{p, p} : Box{min(p, q), max(p, q)};
        std::vector<std::uint32_t> found, expected;
        for_each_overlap(bvh, bvh.frame().local(box),
                         [&](std::uint32_t place) { found.push_back(bvh.order()[place]); });
        std::ranges::sort(found);
        for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
          if (overlap(triangle_box(mesh, t), box)) expected.push_back(t);
        EXPECT_TRUE(std::ranges::includes(found, expected)) << "a box that meets was missed";
        for (const std::uint32_t t : found) EXPECT_TRUE(overlap(triangle_box(mesh, t).grown(1e-5), box));
      }
    }
}

TEST(Bvh, BoxesThatTouchMeet) {
  // A grid of triangles in one plane, whose boxes have no thickness and share edges.
  Mesh mesh;
  for (double x = 0; x < 12; ++x)
    for (double y = 0; y < 12; ++y) add_triangle(mesh, {x, y, 0}, {x + 1, y, 0}, {x + 1, y + 1, 0});
  ProgressMeter unwatched;
  const BvhFrame exact{{}, 1, -1};
  const Bvh bvh(mesh, morton_order(mesh, {}, unwatched), exact, unwatched);
  for (std::uint32_t place = 0; place < bvh.triangles(); ++place) {
    std::vector<std::uint32_t> found, expected;
    std::int64_t boxes = 1 << 30;
    EXPECT_TRUE(for_each_later_overlap(bvh, place, boxes, [&](std::uint32_t other) {
      found.push_back(other);
      return true;
    }));
    for (std::uint32_t other = place + 1; other < bvh.triangles(); ++other)
      if (overlap(triangle_box(mesh, bvh.order()[place]), triangle_box(mesh, bvh.order()[other])))
        expected.push_back(other);
    EXPECT_TRUE(std::ranges::includes(found, expected));
  }
}

TEST(Bvh, FindsEachPairOnceAndInOrder) {
  for (const int triangles : {1, 16, 17, 300, 4097}) {
    const Mesh mesh = random_soup(9, triangles, 1, 0.15);
    const Bvh bvh = bvh_of(mesh, Order::morton);
    std::int64_t pairs = 0, expected = 0;
    for (std::uint32_t place = 0; place < bvh.triangles(); ++place) {
      std::uint32_t last = place;
      std::int64_t boxes = 1 << 30;
      for_each_later_overlap(bvh, place, boxes, [&](std::uint32_t other) {
        EXPECT_GT(other, last);
        last = other;
        pairs += overlap(triangle_box(mesh, bvh.order()[place]), triangle_box(mesh, bvh.order()[other]));
        return true;
      });
      if (triangles > 300) continue;
      for (std::uint32_t other = place + 1; other < bvh.triangles(); ++other)
        expected += overlap(triangle_box(mesh, bvh.order()[place]), triangle_box(mesh, bvh.order()[other]));
    }
    if (triangles <= 300) EXPECT_EQ(pairs, expected);
  }
}

TEST(Bvh, SearchForPairsEndsWhenItIsToldTo) {
  const Mesh mesh = random_soup(10, 500, 0, 1);  // all boxes meet
  const Bvh bvh = bvh_of(mesh, Order::morton);
  std::int64_t few = 100, many = 1 << 30;
  EXPECT_FALSE(for_each_later_overlap(bvh, 0, few, [](std::uint32_t) { return true; }));
  EXPECT_LT(few, 0);
  int visited = 0;
  EXPECT_FALSE(for_each_later_overlap(bvh, 0, many, [&](std::uint32_t) { return ++visited < 7; }));
  EXPECT_EQ(visited, 7);
}

TEST(Bvh, NearestIsTheLowestOfTheNearest) {
  for (const int triangles : kSizes) {
    Mesh mesh = random_soup(11, triangles, 1, 0.2);
    mesh.triangles.insert(mesh.triangles.begin(), mesh.triangles.begin(), mesh.triangles.end());  // each twice
    const Bvh bvh = bvh_of(mesh, Order::halving);
    Random random(12);
    for (int n = 0; n < 50; ++n) {
      const Vec3 p = random.in_cube(n % 5 == 0 ? 1e9 : 2);
      const NearestTriangle found = nearest_triangle(bvh, mesh, p);
      EXPECT_LT(found.triangle, static_cast<std::uint32_t>(triangles)) << "of two copies the first";
      const double least = brute_distance(mesh, p);
      EXPECT_NEAR(found.distance, least, 4e-16 * std::max(least, 1.0)) << triangles;
    }
  }
}

TEST(Bvh, OfNoTrianglesFindsNothing) {
  const Mesh none;
  const Bvh bvh = bvh_of(none, Order::morton);
  EXPECT_EQ(nearest_triangle(bvh, none, {1, 2, 3}).triangle, kNoTriangle);
  for_each_overlap(bvh, FloatBox{{-1, -1, -1}, {1, 1, 1}}, [](std::uint32_t) { ADD_FAILURE(); });
}

}  // namespace
}  // namespace standoff::testing
