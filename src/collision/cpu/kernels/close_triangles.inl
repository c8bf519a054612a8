// SPDX-License-Identifier: Apache-2.0
// The kernels that choose pairs of triangles which may be near each other: by their boxes, and by two separating axes.
#pragma once

#include "collision/cpu/kernels/boxes.inl"
#include "collision/cpu/kernels/target.inl"
#include "geometry/closest_pair.h"

namespace standoff::collision::STANDOFF_TARGET {
namespace {

void transform_triangles(const FloatTransform& transform, const Triangle16& triangles, float by, Triangle16& grown,
                         Aabb16& boxes, FloatBox& all) {
  WidePoint corner[3];
  for (int k = 0; k < 3; ++k) {
    corner[k] = transformed(transform, load_points(triangles.corner[k]));
    store_points(corner[k], grown.corner[k]);
  }
  const WidePoint margin{WideFloat(by), WideFloat(by), WideFloat(by)};
  const WidePoint low = min(corner[0], min(corner[1], corner[2])) - margin,
                  high = max(corner[0], max(corner[1], corner[2])) + margin;
  store_points(low, boxes.min);
  store_points(high, boxes.max);
  all.min[0] = reduce_min(low.x), all.min[1] = reduce_min(low.y), all.min[2] = reduce_min(low.z);
  all.max[0] = reduce_max(high.x), all.max[1] = reduce_max(high.y), all.max[2] = reduce_max(high.z);
}

// The axes are the two normals. A sliver's normal is mostly rounding and may point anywhere. That does no harm: any
// axis may separate, as long as both triangles are projected on it, for a sliver is no point on its own rounded normal.
//
// A projection is off by a few roundings, 2^-24 each, of products no larger than |normal| (the sum of its magnitudes)
// times the span of the corners. kProjectionError is 67 roundings. kProjectionUnderflow covers products that underflow,
// also in programs that flush denormals to zero. With smaller values triangles that touch may be called apart; with
// larger ones more pairs go on to the test in double.
constexpr float kProjectionError = 4e-6f;       // of |normal| times span
constexpr float kProjectionUnderflow = 1e-36f;  // world units, cubed

// Sixteen triangles with their normals, and what each covers on its own normal, seen from its first corner.
struct Planes {
  WidePoint corner[3];
  WidePoint normal;
  WideFloat normal_size;
  WideFloat low, high;
};
STANDOFF_INLINE Planes planes_of(const Triangle16& triangles) {
  Planes p;
  for (int k = 0; k < 3; ++k) p.corner[k] = load_points(triangles.corner[k]);
  const WidePoint edge[2] = {p.corner[1] - p.corner[0], p.corner[2] - p.corner[0]};
  p.normal = plain_cross(edge[0], edge[1]);
  p.normal_size = abs(p.normal.x) + abs(p.normal.y) + abs(p.normal.z);
  const WideFloat zero(0), first = plain_dot(p.normal, edge[0]), second = plain_dot(p.normal, edge[1]);
  p.low = min(zero, min(first, second));
  p.high = max(zero, max(first, second));
  return p;
}

// The same of sixteen triangles, for one lane at a time.
struct PlaneOfLane {
  alignas(64) float normal[3][kLanes], normal_size[kLanes], low[kLanes], high[kLanes];
};
STANDOFF_INLINE PlaneOfLane planes_by_lane(const Triangle16& triangles) {
  const Planes p = planes_of(triangles);
  PlaneOfLane s;
  store_points(p.normal, s.normal);
  p.normal_size.store(s.normal_size);
  p.low.store(s.low);
  p.high.store(s.high);
  return s;
}

// How far apart two sets of points lie on an axis: one covers low to high, the other the three projections.
STANDOFF_INLINE WideFloat separation(const WideFloat (&points)[3], const WideFloat& low, const WideFloat& high) {
  return max(min(points[0], min(points[1], points[2])) - high, low - max(points[0], max(points[1], points[2])));
}

// Which of sixteen triangles may be within `apart` of one lane of others.
STANDOFF_INLINE std::uint32_t not_separated(const Planes& planes, const Triangle16& others, const PlaneOfLane& other,
                                            int lane, float apart) {
  const WidePoint origin = same_points(others.corner[0], lane), normal = same_points(other.normal, lane);
  WideFloat span(0), on_mine[3], on_other[3];
  for (int k = 0; k < 3; ++k) {
    const WidePoint theirs = same_points(others.corner[k], lane) - planes.corner[0], mine = planes.corner[k] - origin;
    on_mine[k] = plain_dot(planes.normal, theirs);
    on_other[k] = plain_dot(normal, mine);
    for (const WidePoint& p : {theirs, mine}) span = max(span, max(abs(p.x), max(abs(p.y), abs(p.z))));
  }
  const WideFloat keep = WideFloat(apart) + WideFloat(kProjectionError) * span, least(kProjectionUnderflow);
  const WideFloat keep_mine = planes.normal_size * keep + least,
                  keep_other = WideFloat(other.normal_size[lane]) * keep + least;
  const WideFloat gap_mine = separation(on_mine, planes.low, planes.high),
                  gap_other = separation(on_other, WideFloat(other.low[lane]), WideFloat(other.high[lane]));
  return less_equal(max(gap_mine - keep_mine, gap_other - keep_other), WideFloat(0)).to_bits();
}

int close_pairs(const TriangleSubset& a, const TriangleSubset& b, float apart, LanePair* pairs) {
  const Planes planes = planes_of(*a.triangles);
  const PlaneOfLane others = planes_by_lane(*b.triangles);
  int count = 0;
  for (std::uint32_t left = b.lanes; left != 0; left &= left - 1) {
    const int lane = __builtin_ctz(left);
    std::uint32_t near = overlaps(*a.boxes, lane_of(*b.boxes, lane)) & a.lanes;
    if (near != 0) near &= not_separated(planes, *b.triangles, others, lane, apart);
    for (; near != 0; near &= near - 1)
      pairs[count++] = {static_cast<std::uint8_t>(__builtin_ctz(near)), static_cast<std::uint8_t>(lane)};
  }
  return count;
}

}  // namespace
}  // namespace standoff::collision::STANDOFF_TARGET
