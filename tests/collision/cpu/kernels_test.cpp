// SPDX-License-Identifier: Apache-2.0
// Compares the kernels that find and decide pairs of triangles with the exact test and with brute force.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <vector>

#include "collision/cpu/kernels.h"
#include "geometry/triangle_distance.h"
#include "geometry/triangle_pair.h"
#include "standoff/pose.h"
#include "tests/geometry/closest_point.h"
#include "tests/support/random_mesh.h"

namespace standoff {
namespace {

using namespace standoff::testing;
using namespace standoff::collision;

struct TwoTriangles {
  Corners p, q;
};

Corners random_triangle(Random& random, Vec3 at, double size) {
  return {at + random.in_cube(size), at + random.in_cube(size), at + random.in_cube(size)};
}

// Pairs that cross, pass by, share corners and edges, lie in one plane, or are slivers, segments and points.
std::vector<TwoTriangles> pairs_of_all_kinds() {
  Random random(7);
  std::vector<TwoTriangles> pairs;
  for (int n = 0; n < 8'000; ++n) {
    const double size = std::pow(10.0, random.between(-9, 9));
    const Vec3 at = random.in_cube(size * std::pow(10.0, random.between(-3, 3)));
    TwoTriangles pair{random_triangle(random, at, size), random_triangle(random, at, size)};
    switch (n % 8) {
      case 1:
        pair.q[0] = pair.p[1];
        break;
      case 2:
        pair.q[0] = pair.p[1], pair.q[1] = pair.p[2];
        break;
      case 3:
        pair.q[0] = (pair.p[0] + pair.p[1]) * 0.5;
        break;
      case 4:
        for (Corners* c : {&pair.p, &pair.q})
          for (Vec3& corner : *c) corner.z = at.z;
        break;
      case 5:
        pair.q[2] = pair.q[0] + (pair.q[1] - pair.q[0]) * 0.3;
        break;
      case 6:
        pair.q = {pair.q[0], pair.q[0], pair.q[0]};
        break;
      case 7:
        pair.q[2] = pair.q[1] + random.in_cube(size * 1e-9);
        break;
      default:
        break;
    }
    pairs.push_back(pair);
  }
  return pairs;
}

void put(const Corners& corners, int lane, double (&to)[3][3][kPairs]) {
  for (int k = 0; k < 3; ++k)
    to[k][0][lane] = corners[k].x, to[k][1][lane] = corners[k].y, to[k][2][lane] = corners[k].z;
}

DoubleTransform transform_of(const Pose& pose) {
  DoubleTransform transform;
  std::copy(pose.rotation.begin(), pose.rotation.end(), transform.rotation);
  transform.translation[0] = pose.translation.x, transform.translation[1] = pose.translation.y;
  transform.translation[2] = pose.translation.z;
  return transform;
}

Corners transformed(const Pose& pose, const Corners& c) {
  return {apply(pose, c[0]), apply(pose, c[1]), apply(pose, c[2])};
}

TEST(PairKernels, MeetAnswersAsTheExactTest) {
  const std::vector<TwoTriangles> all = pairs_of_all_kinds();
  const Pose pose_p = make_pose({1, 2, 3}, 0.7, {}), pose_q = make_pose({-1, 1, 0}, 0.1, {});
  const DoubleTransform transform_p = transform_of(pose_p), transform_q = transform_of(pose_q);
  for (const bool moved : {false, true}) {
    int touching = 0, unsure_of_crossing = 0, crossing = 0;
    for (std::size_t first = 0; first < all.size(); first += kPairs) {
      TrianglePairs pairs;
      for (int n = 0; n < kPairs; ++n) put(all[first + n].p, n, pairs.p), put(all[first + n].q, n, pairs.q);
      PairOverlaps overlap;
      best_kernels().overlap_pairs(pairs, moved ? &transform_p : nullptr, moved ? &transform_q : nullptr, overlap);
      for (int n = 0; n < kPairs; ++n) {
        const Corners p = moved ? transformed(pose_p, all[first + n].p) : all[first + n].p,
                      q = moved ? transformed(pose_q, all[first + n].q) : all[first + n].q;
        const bool told = (overlap.intersecting >> n & 1) != 0, unsure = (overlap.unsure >> n & 1) != 0;
        const bool touch = triangles_intersect(p, q);
        ASSERT_FALSE(told && unsure);
        if (!unsure) {
          ASSERT_EQ(told, touch) << "pair " << first + n << " of kind " << (first + n) % 8;
        }
        touching += told;
        if ((first + n) % 8 == 0) crossing += touch, unsure_of_crossing += unsure;
      }
    }
    EXPECT_GT(touching, 200);
    EXPECT_GT(crossing, 40);
    EXPECT_LT(unsure_of_crossing, 10) << "of 1,000 pairs in no special position";
  }
}

TEST(PairKernels, MeetTellsWhereAndHowDeep) {
  Random random(3);
  int compared = 0;
  for (int round = 0; round < 500; ++round) {
    TrianglePairs pairs;
    TwoTriangles two[kPairs];
    for (int n = 0; n < kPairs; ++n) {
      two[n] = {random_triangle(random, {}, 1), random_triangle(random, {}, 1)};
      put(two[n].p, n, pairs.p), put(two[n].q, n, pairs.q);
    }
    PairOverlaps overlap;
    best_kernels().overlap_pairs(pairs, nullptr, nullptr, overlap);
    for (int n = 0; n < kPairs; ++n) {
      if ((overlap.intersecting >> n & 1) == 0) continue;
      const Penetration expected = penetration(two[n].p, two[n].q);
      const Vec3 point{overlap.point[0][n], overlap.point[1][n], overlap.point[2][n]},
          normal{overlap.normal[0][n], overlap.normal[1][n], overlap.normal[2][n]};
      EXPECT_LT(length(point - expected.point), 1e-9);
      EXPECT_NEAR(overlap.depth[n], expected.depth, 1e-12);
      EXPECT_LT(length(normal - expected.normal), 1e-9);
      ++compared;
    }
  }
  EXPECT_GT(compared, 300);
}

// The distance of two convex sets by alternating projections: slow, but independent of the kernel.
double distance_by_projections(const Corners& p, const Corners& q) {
  const auto triple = [](const Vec3& v) { return Triple<double>{v.x, v.y, v.z}; };
  // A segment's closest point is on one of its edges.
  const auto onto = [&](const Triple<double>& x, const Corners& t) {
    Triple<double> best = closest_on_triangle(x, triple(t[0]), triple(t[1]), triple(t[2]));
    for (int k = 0; k < 3; ++k) {
      const Triple<double> other = closest_on_segment(x, triple(t[k]), triple(t[(k + 1) % 3]));
      if (dot(other - x, other - x) < dot(best - x, best - x)) best = other;
    }
    return best;
  };
  double least = 1e300;
  for (const Vec3& start : p) {
    Triple<double> on_p = triple(start), on_q = onto(on_p, q);
    for (int n = 0; n < 1500; ++n) on_p = onto(on_q, p), on_q = onto(on_p, q);
    const Triple<double> separation = on_q - on_p;
    least = std::min(least, std::sqrt(dot(separation, separation)));
  }
  return least;
}

double distance_from(const Vec3& point, const Corners& t) {
  const auto triple = [](const Vec3& v) { return Triple<double>{v.x, v.y, v.z}; };
  return std::sqrt(origin_distance_sq(triple(t[0] - point), triple(t[1] - point), triple(t[2] - point)));
}

TEST(PairKernels, ClosestPointsAreOnTheTrianglesAndNoOthersAreCloser) {
  Random random(13);
  double farthest_off = 0, off_surface = 0;
  int apart = 0;
  for (int round = 0; round < 20; ++round) {
    TrianglePairs pairs;
    TwoTriangles two[kPairs];
    for (int n = 0; n < kPairs; ++n) {
      two[n] = {random_triangle(random, {}, 1), random_triangle(random, {0.7, 0.7, 0.7}, 1)};
      if (n == 1) two[n].q[1] = two[n].q[0];                                // a segment
      if (n == 2) two[n].p[2] = two[n].p[1] = two[n].p[0];                  // a point
      if (n == 3) two[n].q[1] = two[n].q[0] + (two[n].p[1] - two[n].p[0]);  // parallel edges
      put(two[n].p, n, pairs.p), put(two[n].q, n, pairs.q);
    }
    ClosestOfPairs found;
    best_kernels().closest(pairs, nullptr, nullptr, found);
    for (int n = 0; n < kPairs; ++n) {
      if (triangles_intersect(two[n].p, two[n].q)) continue;
      const Vec3 on_p{found.on_p[0][n], found.on_p[1][n], found.on_p[2][n]},
          on_q{found.on_q[0][n], found.on_q[1][n], found.on_q[2][n]};
      const double distance = std::sqrt(found.distance_sq[n]);
      off_surface = std::max({off_surface, distance_from(on_p, two[n].p), distance_from(on_q, two[n].q),
                              std::abs(length(on_q - on_p) - distance)});
      farthest_off = std::max(farthest_off, std::abs(distance - distance_by_projections(two[n].p, two[n].q)));
      ++apart;
    }
  }
  EXPECT_GT(apart, 100);
  EXPECT_LT(off_surface, 1e-14);
  EXPECT_LT(farthest_off, 1e-6) << "projections in turns come that near";
}

TEST(PairKernels, EightAtATimeAreMeasuredAsOneByOne) {
  const std::vector<TwoTriangles> all = pairs_of_all_kinds();
  const DoubleTransform transform = transform_of(make_pose({1, 2, 3}, 0.7, {1, 2, 3}));
  const Pose pose = make_pose({1, 2, 3}, 0.7, {1, 2, 3});
  for (std::size_t first = 0; first < all.size(); first += kPairs) {
    TrianglePairs pairs;
    for (int n = 0; n < kPairs; ++n) put(all[first + n].p, n, pairs.p), put(all[first + n].q, n, pairs.q);
    for (const Kernels* row : all_kernels()) {
      ClosestOfPairs found;
      row->closest(pairs, nullptr, &transform, found);
      for (int n = 0; n < kPairs; ++n) {
        const ClosestPair one = closest_points(all[first + n].p, transformed(pose, all[first + n].q));
        ASSERT_EQ(found.distance_sq[n], one.distance_sq) << row->name << ", pair " << first + n;
        ASSERT_EQ(found.on_p[0][n], one.on_p.x);
        ASSERT_EQ(found.on_q[2][n], one.on_q.z);
      }
    }
  }
}

struct Sixteen {
  Triangle16 triangles;
  Boxes16 boxes;
  Corners corners[kLanes];
};

Sixteen random_packet(Random& random, float by) {
  Triangle16 triangles;
  Sixteen packet;
  for (int n = 0; n < kLanes; ++n) {
    const Corners c = random_triangle(random, random.in_cube(1), n % 4 == 0 ? 0.01 : 0.5);
    for (int k = 0; k < 3; ++k) {
      const Vec3 rounded{float(c[k].x), float(c[k].y), float(c[k].z)};
      packet.corners[n][k] = rounded;
      triangles.corner[k][0][n] = float(c[k].x), triangles.corner[k][1][n] = float(c[k].y),
      triangles.corner[k][2][n] = float(c[k].z);
    }
  }
  FloatBox all;
  const FloatTransform here{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
  best_kernels().transform_triangles(here, triangles, by, packet.triangles, packet.boxes, all);
  return packet;
}

TEST(PairKernels, NoPairWithinTheLimitIsLeftOut) {
  Random random(11);
  const float limit = 0.05f;
  int near = 0, kept = 0;
  for (int round = 0; round < 200; ++round) {
    const Sixteen a = random_packet(random, 0), b = random_packet(random, limit);
    LanePair pairs[kLanes * kLanes];
    bool told[kLanes][kLanes] = {};
    const std::uint32_t lanes_a = 0xfff7, lanes_b = 0x7fff;
    const int count =
        best_kernels().close_pairs({&a.triangles, &a.boxes, lanes_a}, {&b.triangles, &b.boxes, lanes_b}, limit, pairs);
    for (int n = 0; n < count; ++n) {
      ASSERT_TRUE((lanes_a >> pairs[n].a & 1) != 0 && (lanes_b >> pairs[n].b & 1) != 0) << "a lane that was not given";
      ASSERT_FALSE(told[pairs[n].a][pairs[n].b]) << "a pair told twice";
      told[pairs[n].a][pairs[n].b] = true;
    }
    kept += count;
    for (int i = 0; i < kLanes; ++i)
      for (int j = 0; j < kLanes; ++j) {
        if ((lanes_a >> i & 1) == 0 || (lanes_b >> j & 1) == 0) continue;
        if (!triangles_intersect(a.corners[i], b.corners[j]) &&
            closest_points(a.corners[i], b.corners[j]).distance_sq > double{limit} * limit)
          continue;
        ++near;
        EXPECT_TRUE(told[i][j]);
      }
  }
  EXPECT_GT(near, 500);
  EXPECT_LT(kept, 3 * near) << "nearly nothing is left out";
}

TEST(PairKernels, AgreeBitForBit) {
  Random random(5);
  const std::span<const Kernels* const> rows = all_kernels();
  const std::vector<TwoTriangles> all = pairs_of_all_kinds();
  const DoubleTransform transform = transform_of(make_pose({1, 2, 3}, 0.7, {1, 2, 3}));
  const FloatTransform turned{{0.6f, -0.8f, 0, 0.8f, 0.6f, 0, 0, 0, 1}, {0.1f, 0.2f, -0.3f}};
  for (std::size_t k = 1; k < rows.size(); ++k) {
    for (std::size_t first = 0; first < all.size(); first += kPairs) {
      TrianglePairs pairs;
      for (int n = 0; n < kPairs; ++n) put(all[first + n].p, n, pairs.p), put(all[first + n].q, n, pairs.q);
      PairOverlaps a, b;
      rows[0]->overlap_pairs(pairs, &transform, nullptr, a);
      rows[k]->overlap_pairs(pairs, &transform, nullptr, b);
      ASSERT_EQ(a.intersecting, b.intersecting) << rows[0]->name << " and " << rows[k]->name;
      ASSERT_EQ(a.unsure, b.unsure);
      for (int n = 0; n < kPairs; ++n) {
        if ((a.intersecting >> n & 1) == 0) continue;
        for (int axis = 0; axis < 3; ++axis) {
          ASSERT_EQ(a.point[axis][n], b.point[axis][n]);
          ASSERT_EQ(a.normal[axis][n], b.normal[axis][n]);
        }
        ASSERT_EQ(a.depth[n], b.depth[n]);
      }
    }
    for (int round = 0; round < 50; ++round) {
      const Sixteen one = random_packet(random, 0), other = random_packet(random, 0.1f);
      Triangle16 triangles[2];
      Boxes16 boxes[2];
      FloatBox around[2];
      LanePair pairs[2][kLanes * kLanes];
      int count[2];
      for (const int which : {0, 1}) {
        const Kernels& kernels = *rows[which == 0 ? 0 : k];
        kernels.transform_triangles(turned, one.triangles, 0.1f, triangles[which], boxes[which], around[which]);
        count[which] = kernels.close_pairs({&triangles[which], &boxes[which], 0xffff},
                                           {&other.triangles, &other.boxes, 0xffff}, 0.1f, pairs[which]);
      }
      ASSERT_EQ(std::memcmp(&triangles[0], &triangles[1], sizeof triangles[0]), 0);
      ASSERT_EQ(std::memcmp(&boxes[0], &boxes[1], sizeof boxes[0]), 0);
      ASSERT_EQ(std::memcmp(&around[0], &around[1], sizeof around[0]), 0);
      ASSERT_EQ(count[0], count[1]);
      ASSERT_EQ(std::memcmp(pairs[0], pairs[1], static_cast<std::size_t>(count[0]) * sizeof(LanePair)), 0);
    }
  }
}

}  // namespace
}  // namespace standoff
