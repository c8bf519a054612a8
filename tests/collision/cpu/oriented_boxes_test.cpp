// SPDX-License-Identifier: Apache-2.0
// Oriented boxes: that they hold their triangles, that their bounds are bounds, and that all instruction sets agree.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "collision/body/body.h"
#include "collision/cpu/kernels.h"
#include "collision/node_pairs.h"
#include "tests/collision/bodies.h"

namespace standoff {
namespace {

using namespace standoff::testing;
using namespace standoff::collision;

Vec3 point_in(const Obb& box, const Vec3& at) {
  Vec3 p{box.center[0], box.center[1], box.center[2]};
  for (int k = 0; k < 3; ++k)
    p = p + Vec3{box.axis[k][0], box.axis[k][1], box.axis[k][2]} * (double{box.half[k]} * at[k]);
  return p;
}

Obb random_box(Random& random, double size) {
  Obb box;
  const std::array<Vec3, 3> axes = axes_about(random.in_cube(1));
  const Vec3 center = random.in_cube(3 * size);
  for (std::size_t k = 0; k < 3; ++k) {
    box.center[k] = static_cast<float>(center[static_cast<int>(k)]);
    box.half[k] = static_cast<float>(size * std::pow(10.0, random.between(-4, 0)));
    for (int j = 0; j < 3; ++j) box.axis[k][j] = static_cast<float>(axes[k][j]);
  }
  return box;
}

// The bound was infinite where the fourth power of a length overflowed: bodies of 3e11 were told a distance too large.
TEST(OrientedBoxes, ABoundIsNeverAboveADistance) {
  Random random(1);
  double tightest = 0;
  for (const double size : {1e-12, 1e-3, 1.0, 1e4, 1e12})
    for (int n = 0; n < 300; ++n) {
      Obb16 boxes;
      for (int lane = 0; lane < kLanes; ++lane) boxes.set(lane, random_box(random, size));
      const Obb box = random_box(random, size);
      float axes[3][3];
      const std::array<Vec3, 3> frame = axes_about(random.in_cube(1));
      for (std::size_t k = 0; k < 3; ++k)
        for (int j = 0; j < 3; ++j) axes[k][j] = static_cast<float>(frame[k][j]);
      alignas(64) float bound_sq[kLanes], without[kLanes], other[kLanes];
      best_kernels().obb_distances_sq(boxes, box, nullptr, 0, without);
      const float most_sq = without[0];
      best_kernels().obb_distances_sq(boxes, box, axes, most_sq, bound_sq);
      std::uint32_t within = 0;
      for (int lane = 0; lane < kLanes; ++lane) within |= std::uint32_t{bound_sq[lane] <= most_sq} << lane;
      for (const Kernels* kernels : all_kernels()) {
        EXPECT_EQ(kernels->obb_distances_sq(boxes, box, axes, most_sq, other), within) << kernels->name;
        EXPECT_EQ(std::memcmp(bound_sq, other, sizeof other), 0) << kernels->name;
      }
      for (int lane = 0; lane < kLanes; ++lane) {
        EXPECT_GE(bound_sq[lane], without[lane]);
        double least = std::numeric_limits<double>::infinity();
        const auto sign = [](int bits, int axis) { return bits >> axis & 1 ? 1.0 : -1.0; };
        for (int a = 0; a < 8; ++a)
          for (int b = 0; b < 8; ++b)
            least = std::min(least, length(point_in(boxes.lane(lane), {sign(a, 0), sign(a, 1), sign(a, 2)}) -
                                           point_in(box, {sign(b, 0), sign(b, 1), sign(b, 2)})));
        const double allowed = kFarShare * least + kNodePairSlack * 8 * size;
        EXPECT_LE(std::sqrt(bound_sq[lane]), least + allowed) << size;
        tightest = std::max(tightest, std::sqrt(bound_sq[lane]) / least);
      }
    }
  EXPECT_GT(tightest, 0.9) << "bounds are good for nothing";
}

TEST(OrientedBoxes, NoNearPairOfTrianglesIsLeftOut) {
  Random random(2);
  int kept = 0;
  for (int n = 0; n < 300; ++n) {
    Triangle16 first, second;
    std::array<Corners, kLanes> p, q;
    for (std::size_t lane = 0; lane < kLanes; ++lane)
      for (int set = 0; set < 2; ++set) {
        const Vec3 at = random.in_cube(1) + Vec3{set * 1.5, 0, 0};
        Corners& corners = set == 0 ? p[lane] : q[lane];
        for (std::size_t k = 0; k < 3; ++k) {
          const Vec3 corner = at + random.in_cube(0.2);
          for (int axis = 0; axis < 3; ++axis)
            (set == 0 ? first : second).corner[k][axis][lane] = static_cast<float>(corner[axis]);
          corners[k] = {first.corner[k][0][lane], first.corner[k][1][lane], first.corner[k][2][lane]};
          if (set == 1) corners[k] = {second.corner[k][0][lane], second.corner[k][1][lane], second.corner[k][2][lane]};
        }
      }
    const float of_first[3] = {0.1f, -0.2f, 0.3f}, of_second[3] = {1.4f, 0.1f, 0.2f};
    const Vec3 offset{double{of_second[0]} - of_first[0], double{of_second[1]} - of_first[1],
                      double{of_second[2]} - of_first[2]};
    LeafAxes axes[2];
    for (LeafAxes& set : axes) {
      const std::array<Vec3, 3> frame = axes_about(random.in_cube(1));
      for (std::size_t k = 0; k < 3; ++k) {
        for (int j = 0; j < 3; ++j) set.first[k][j] = set.second[k][j] = static_cast<float>(frame[k][j]);
        set.offset[k] = static_cast<float>(dot(frame[k], offset));
      }
    }
    const int of_p = 1 + static_cast<int>(random.below(16)), of_q = 1 + static_cast<int>(random.below(16));
    const double limit = random.between(0, 1);
    LeafPair pairs[kLanes * kLanes], others[kLanes * kLanes];
    const auto find = [&](const Kernels& kernels, LeafPair* to) {
      const double most = limit + kLeafSlack * 4;
      return kernels.near_triangles(first, of_first, of_p, second, of_second, of_q, axes,
                                    static_cast<float>(most * most), to);
    };
    const int count = find(best_kernels(), pairs);
    for (const Kernels* kernels : all_kernels()) {
      ASSERT_EQ(find(*kernels, others), count) << kernels->name;
      for (int k = 0; k < count; ++k) EXPECT_EQ(std::memcmp(&pairs[k], &others[k], 6), 0) << kernels->name;
    }
    kept += count;
    for (int i = 0; i < of_p; ++i)
      for (int j = 0; j < of_q; ++j) {
        const auto is_it = [&](const LeafPair& pair) { return pair.first == i && pair.second == j; };
        const double distance_sq =
            closest_points(p[static_cast<std::size_t>(i)], q[static_cast<std::size_t>(j)]).distance_sq;
        if (distance_sq <= limit * limit) EXPECT_TRUE(std::any_of(pairs, pairs + count, is_it)) << i << " " << j;
      }
    for (int k = 0; k < count; ++k) EXPECT_TRUE(pairs[k].first < of_p && pairs[k].second < of_q);
  }
  EXPECT_LT(kept, 300 * 256 / 4) << "nearly all pairs are kept";
}

TEST(OrientedBoxes, OfABodyHoldTheirTriangles) {
  for (const Mesh& mesh : {ball_mesh(1, 20, {5, 6, 7}), random_soup(3, 700, 1, 0.2), random_soup(4, 5, 1e-9, 1e-10),
                           random_soup(5, 300, 1e9, 1e7, {1e10, 0, 0}), Mesh{{{0, 0, 0}}, {{0, 0, 0}}}}) {
    const Body model(mesh);
    const BodyData& data = data_of(model);
    for (int level = 0; level <= data.bvh.top(); ++level) {
      const auto nodes = static_cast<std::uint32_t>(data.bvh.tree.level(level).size());
      for (std::uint32_t node = 0; node < nodes; ++node) {
        const Obb box = data.bvh.box_of(level, node);
        const std::size_t size = std::size_t{1} << 4 * (level + 1);
        for (std::size_t n = size * node; n < std::min(size * (node + 1), data.corners.size()); ++n)
          for (const Vec3& corner : data.corners[n]) {
            const Vec3 from = corner - data.middle - Vec3{box.center[0], box.center[1], box.center[2]};
            for (int k = 0; k < 3; ++k)
              EXPECT_LE(std::abs(dot(from, {box.axis[k][0], box.axis[k][1], box.axis[k][2]})),
                        box.half[k] + 1e-7 * data.radius);
          }
      }
    }
  }
}

}  // namespace
}  // namespace standoff
