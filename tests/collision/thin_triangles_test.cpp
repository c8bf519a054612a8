// SPDX-License-Identifier: Apache-2.0
// Triangles so thin that rounding turns their normals, and triangles that they lie on: distances and points of contact.
#include <gtest/gtest.h>

#include <cmath>

#include "collision/cpu/kernels.h"
#include "geometry/triangle_pair.h"
#include "tests/collision/bodies.h"
#include "tests/collision/zoo/gap.h"
#include "tests/collision/zoo/slivers.h"

namespace standoff {
namespace {

using namespace standoff::testing;

Corners moved_by(const Corners& t, Vec3 by) { return {t[0] + by, t[1] + by, t[2] + by}; }

// Determinants of nearly parallel edges are mostly rounding. The closest points of lines were once solved with them,
// with errors of up to a ten-millionth of the edges, and so was the distance of edges that nearly touch.
TEST(ThinTriangles, DistancesOfNearlyParallelEdgesAreRightToRounding) {
  Random random(1);
  double worst = 0;
  for (int n = 0; n < 20'000; ++n) {
    const double angle = log_between(random, 1e-16, 1), apart = log_between(random, 1e-16, 1);
    const Vec3 at = random.in_cube(1), along = direction(random), up = direction(random);
    const Corners p{at - along, at + along, at - up};
    const Vec3 turned = along + direction(random) * angle, start = at + up * apart;
    const Corners q{start - turned, start + turned, start + up};
    if (triangles_intersect(p, q)) continue;
    const double off = std::abs(std::sqrt(closest_points(p, q).distance_sq) - gap(p, q)) / extent_of(p, q);
    worst = std::max(worst, off);
  }
  EXPECT_LE(worst, kDistanceRounding);
  EXPECT_GT(worst, 0) << "something was compared";
}

// A foot inside a sliver once came from its normal, whose error was the rounding divided by its height.
TEST(ThinTriangles, DistancesOfSliversAreRightToRounding) {
  Random random(2);
  double worst = 0, off_triangle = 0, way_off = 0;
  for (int n = 0; n < 20'000; ++n) {
    SliverPair pair = sliver_pair(random, log_between(random, 1e-15, 1), Thin::any_way, TriangleOverlap::near);
    const Vec3 far = n % 2 ? random.in_cube(1e6) : Vec3{};
    const Corners p = moved_by(pair.p, far), q = moved_by(pair.q, far);
    if (triangles_intersect(p, q)) continue;
    const ClosestPair found = closest_points(p, q);
    const double extent = extent_of(p, q), place = extent + length(far);
    worst = std::max(worst, std::abs(std::sqrt(found.distance_sq) - gap(p, q)) / extent);
    way_off = std::max(way_off, std::abs(length(found.separation) - std::sqrt(found.distance_sq)) / extent);
    off_triangle = std::max({off_triangle, root_of(point_triangle_sq(found.on_p, p)) / place,
                             root_of(point_triangle_sq(found.on_q, q)) / place});
  }
  EXPECT_LE(worst, kDistanceRounding);
  EXPECT_LE(way_off, 0x1p-52);
  EXPECT_LE(off_triangle, 4 * 0x1p-53);
}

// Pairs that the separating axes exclude must be apart: a sliver's rounded normal may point anywhere, even along it.
TEST(ThinTriangles, NoneIsPartedFromWhatItTouches) {
  Random random(3);
  int touching = 0;
  for (int round = 0; round < 2'000; ++round) {
    const double ratio = log_between(random, 1e-12, 1e-2);
    collision::Triangle16 faces[2];
    Corners corners[2][collision::kLanes];
    for (int n = 0; n < collision::kLanes; ++n) {
      const SliverPair pair = sliver_pair(random, ratio, Thin::any_way, TriangleOverlap::touching);
      for (const int which : {0, 1}) {
        const Corners& from = which == 0 ? pair.p : pair.q;
        for (int k = 0; k < 3; ++k) {
          const float x = float(from[k].x), y = float(from[k].y), z = float(from[k].z);
          faces[which].corner[k][0][n] = x, faces[which].corner[k][1][n] = y, faces[which].corner[k][2][n] = z;
          corners[which][n][k] = {x, y, z};
        }
      }
    }
    const FloatTransform here{{1, 0, 0, 0, 1, 0, 0, 0, 1}, {0, 0, 0}};
    for (const collision::Kernels* row : collision::all_kernels()) {
      const collision::Kernels& kernels = *row;
      collision::Triangle16 placed[2];
      Boxes16 boxes[2];
      FloatBox all;
      for (const int which : {0, 1})
        kernels.transform_triangles(here, faces[which], 0, placed[which], boxes[which], all);
      collision::LanePair pairs[collision::kLanes * collision::kLanes];
      const int count = kernels.close_pairs({&placed[0], &boxes[0], 0xffff}, {&placed[1], &boxes[1], 0xffff}, 0, pairs);
      bool told[collision::kLanes][collision::kLanes] = {};
      for (int n = 0; n < count; ++n) told[pairs[n].a][pairs[n].b] = true;
      for (int i = 0; i < collision::kLanes; ++i)
        for (int j = 0; j < collision::kLanes; ++j) {
          if (!triangles_intersect(corners[0][i], corners[1][j])) continue;
          ++touching;
          EXPECT_TRUE(told[i][j]) << kernels.name;
        }
    }
  }
  EXPECT_GT(touching, 10'000);
}

// Any pair that is moved along the normal by a little more than the depth is apart.
void expect_way_out(const Corners& p, const Corners& q) {
  ASSERT_TRUE(triangles_intersect(p, q));
  const Penetration found = penetration(p, q);
  const double extent = std::max(extent_of(p, q), 1e-300);
  EXPECT_NEAR(length(found.normal), 1, 1e-15);
  EXPECT_GE(found.depth, 0);
  EXPECT_FALSE(triangles_intersect(p, moved_by(q, found.normal * (found.depth + kPenetrationError * extent))));
  EXPECT_LE(root_of(point_triangle_sq(found.point, p)), kPenetrationError * extent);
  EXPECT_LE(root_of(point_triangle_sq(found.point, q)), kPenetrationError * extent);
}

TEST(ThinTriangles, SegmentsAndPointsHaveAWayOut) {
  const Vec3 o{0, 0, 0}, x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
  const Corners point{o, o, o}, along_x{x * -1.0, x, o}, along_y{y * -1.0, y, o}, later_x{x * 0.5, x * 2.0, x},
      flat{x * -1.0, x + y, x - y}, upright{z, z * -1.0, y * 3.0};
  const Corners all[] = {point, along_x, along_y, later_x, flat, upright};
  int touching = 0;
  for (const Corners& p : all)
    for (const Corners& q : all) {
      if (!triangles_intersect(p, q)) continue;
      ++touching;
      expect_way_out(p, q);
    }
  EXPECT_GT(touching, 20);
}

TEST(ThinTriangles, SliversHaveAWayOutAndAPointOnBoth) {
  Random random(5);
  int touching = 0;
  for (int n = 0; n < 20'000; ++n) {
    const SliverPair pair = sliver_pair(random, log_between(random, 1e-15, 1), n % 2 ? Thin::any_way : Thin::along_z,
                                        TriangleOverlap::touching);
    if (!triangles_intersect(pair.p, pair.q)) continue;
    ++touching;
    expect_way_out(pair.p, pair.q);
  }
  EXPECT_GT(touching, 5'000);
}

// The point of distance() for touching bodies. From computed normals, its error was up to 1,400 roundings of a
// coordinate.
TEST(ThinTriangles, ACommonPointIsOnBothToRounding) {
  Random random(6);
  int touching = 0;
  double worst = 0;
  for (int n = 0; n < 40'000; ++n) {
    // Slivers, mostly about a hundredth as high as long; at the origin, or farther away than they are long.
    const double ratio = n % 4 ? log_between(random, 1e-4, 1e-1) : log_between(random, 1e-15, 1);
    const SliverPair pair = sliver_pair(random, ratio, Thin::any_way, TriangleOverlap::touching);
    const Vec3 far = random.in_cube(n % 3);
    const Corners p = moved_by(pair.p, far), q = moved_by(pair.q, far);
    if (!triangles_intersect(p, q)) continue;
    ++touching;
    const Vec3 point = common_point(p, q);
    double coordinate = 0;
    for (int k = 0; k < 3; ++k) coordinate = std::max({coordinate, max_norm(p[k]), max_norm(q[k])});
    worst = std::max(
        {worst, root_of(point_triangle_sq(point, p)) / coordinate, root_of(point_triangle_sq(point, q)) / coordinate});
  }
  EXPECT_LE(worst, 8 * 0x1p-53);
  EXPECT_GT(touching, 10'000);
}

// The middle of the segment that both share, not one of its ends, for triangles in general position too.
TEST(ThinTriangles, TheSharedSegmentsMiddleIsThePoint) {
  const Corners flat{Vec3{0, 0, 0}, Vec3{4, 0, 0}, Vec3{0, 4, 0}};
  const Penetration found = penetration(flat, {Vec3{1, 1, 1}, Vec3{1, 1, -1}, Vec3{-3, 1, -1}});
  EXPECT_NEAR(length(found.point - Vec3{0.5, 1, 0}), 0, 1e-15);
  EXPECT_NEAR(found.depth, 1, 1e-15);
}

// If closest points are very near, rounding decides the direction between them; then the slab lies along a feature.
TEST(ThinTriangles, TheSlabIsAsThickAsTheyAreApart) {
  Random random(7);
  int near = 0;
  for (int n = 0; n < 20'000; ++n) {
    const double apart = log_between(random, 1e-14, 1e-2);
    const Vec3 up = direction(random), x = cross(up, direction(random)), y = cross(up, x);
    const auto in_plane = [&] { return x * random.between(-1, 1) + y * random.between(-1, 1); };
    Corners p{in_plane(), in_plane(), in_plane()};
    const Vec3 above = (p[0] + p[1] + p[2]) * (1 / 3.0) + up * apart;
    const Corners q{above, above + up + in_plane(), above + up * 0.5 + in_plane()};
    if (triangles_intersect(p, q)) continue;
    const ClosestPair closest = closest_points(p, q);
    const double distance = std::sqrt(closest.distance_sq);
    const Slab slab = slab_between(p, q, closest);
    EXPECT_LE(slab.thickness, distance + 1e-15);
    if (distance > 1e-13) {
      EXPECT_GT(slab.thickness, 0.25 * distance);
    }
    near += distance < 1e-9;
  }
  EXPECT_GT(near, 3'000);
}

}  // namespace
}  // namespace standoff
