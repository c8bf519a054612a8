// SPDX-License-Identifier: Apache-2.0
// The queries' kernels for the instruction set of the file that includes this: they take sixteen floats or eight
// doubles at a time. No operations are fused, so all sets give the same bits.
#pragma once

#include <utility>

#include "bvh/overlapping.inl"
#include "collision/body/box_distance.h"
#include "collision/body/kernel_data.h"
#include "collision/cpu/kernels.h"
#include "collision/cpu/moving_kernels.inl"
#include "geometry/closest_pair.h"
#include "geometry/overlap_penetration.h"
#include "simd/points.inl"

namespace standoff::collision::STANDOFF_TARGET {

using namespace standoff::STANDOFF_TARGET;

static_assert(kLanes == WideFloat::kLanes && kPairs == WideDouble::kLanes);

namespace {

/// One point in all lanes.
STANDOFF_INLINE WidePoint same_points(const float* at) {
  return {WideFloat(at[0]), WideFloat(at[1]), WideFloat(at[2])};
}
/// One of sixteen points in all lanes.
STANDOFF_INLINE WidePoint same_points(const float (&at)[3][kLanes], int lane) {
  return {WideFloat(at[0][lane]), WideFloat(at[1][lane]), WideFloat(at[2][lane])};
}

STANDOFF_INLINE WidePoint min(const WidePoint& a, const WidePoint& b) {
  return {min(a.x, b.x), min(a.y, b.y), min(a.z, b.z)};
}
STANDOFF_INLINE WidePoint max(const WidePoint& a, const WidePoint& b) {
  return {max(a.x, b.x), max(a.y, b.y), max(a.z, b.z)};
}

/// Sixteen points, transformed to another frame.
STANDOFF_INLINE WidePoint transformed(const FloatTransform& transform, const WidePoint& p) {
  const auto row = [&](int axis) __attribute__((always_inline)) {
    const float* const r = transform.rotation + 3 * axis;
    return WideFloat(r[0]) * p.x + WideFloat(r[1]) * p.y + WideFloat(r[2]) * p.z +
           WideFloat(transform.translation[axis]);
  };
  return {row(0), row(1), row(2)};
}

// Sixteen oriented boxes against one, and two leaves of sixteen triangles against each other (box_distance.h).

std::uint32_t obb_distances_sq(const Obb16& boxes, const Obb& box, const float (*axes)[3], float most_sq,
                               float* distance_sq) {
  const OrientedBoxes<WideFloat> sixteen{
      load_points(boxes.center),
      {load_points(boxes.axis[0]), load_points(boxes.axis[1]), load_points(boxes.axis[2])},
      {WideFloat::load(boxes.half[0]), WideFloat::load(boxes.half[1]), WideFloat::load(boxes.half[2])}};
  const WideFloat best = box_distance_sq(sixteen, box, axes);
  best.store(distance_sq);
  return less_equal(best, WideFloat(most_sq)).to_bits();
}

using Projections = Projection<WideFloat>;  // of sixteen triangles
// The interval around all, in all lanes.
STANDOFF_INLINE Projections around(const Projections& p) {
  return {WideFloat(reduce_min(p.low)), WideFloat(reduce_max(p.high))};
}

// The two leaves along one set of axes: the projections of the first one's triangles in arrays, to read one at a time.
struct LeafProjections {
  alignas(64) float low[3][kLanes], high[3][kLanes];
  Projections second[3];
};

int near_triangles(const Triangle16& first, const float (&center)[3], int count, const Triangle16& second,
                   const float (&second_center)[3], int second_count, const LeafAxes (&axes)[2], float most_sq,
                   LeafPair* pairs) {
  WidePoint mine[3], theirs[3];
  for (int k = 0; k < 3; ++k) {
    mine[k] = load_points(first.corner[k]) - same_points(center);
    theirs[k] = load_points(second.corner[k]) - same_points(second_center);
  }
  const auto project = [&](int set, int k) __attribute__((always_inline)) {
    const Projections moved = projected(theirs, axes[set].second[k]);
    const WideFloat offset(axes[set].offset[k]);
    return std::pair(projected(mine, axes[set].first[k]), Projections{moved.low + offset, moved.high + offset});
  };
  // Most pairs of leaves, and most triangles of the others, are too far apart along the first axis alone.
  std::pair<Projections, Projections> both = project(0, 0);
  const auto near_all = [&](const Projections& some, const Projections& others) __attribute__((always_inline)) {
    return less_equal(squared_gap(some, around(others)), WideFloat(most_sq)).to_bits();
  };
  std::uint32_t rows = near_all(both.first, both.second) & ((1u << count) - 1);
  if (rows == 0) return 0;
  const std::uint32_t lanes = near_all(both.second, both.first) & ((1u << second_count) - 1);
  LeafProjections along_axes[2];
  for (int set = 0; set < 2; ++set)
    for (int k = 0; k < 3; ++k) {
      if (set + k > 0) both = project(set, k);
      both.first.low.store(along_axes[set].low[k]);
      both.first.high.store(along_axes[set].high[k]);
      along_axes[set].second[k] = both.second;
    }
  int found = 0;
  for (; rows != 0; rows &= rows - 1) {
    const int n = __builtin_ctz(rows);
    WideFloat best(0);
    for (const LeafProjections& set : along_axes) {
      WideFloat sum(0);
      for (int k = 0; k < 3; ++k)
        sum = sum + squared_gap(Projections{WideFloat(set.low[k][n]), WideFloat(set.high[k][n])}, set.second[k]);
      best = max(best, sum);
    }
    std::uint32_t near = less_equal(best, WideFloat(most_sq)).to_bits() & lanes;
    if (near == 0) continue;
    alignas(64) float distance_sq[kLanes];
    best.store(distance_sq);
    for (; near != 0; near &= near - 1) {
      const int lane = __builtin_ctz(near);
      pairs[found++] = {distance_sq[lane], static_cast<std::uint8_t>(n), static_cast<std::uint8_t>(lane)};
    }
  }
  return found;
}

// Pairs of triangles are excluded by their boxes and by two separating axes.

void transform_triangles(const FloatTransform& transform, const Triangle16& triangles, float by, Triangle16& grown,
                         Boxes16& boxes, FloatBox& all) {
  WidePoint corner[3];
  for (int k = 0; k < 3; ++k) {
    corner[k] = transformed(transform, load_points(triangles.corner[k]));
    store_points(corner[k], grown.corner[k]);
  }
  const WidePoint margin{WideFloat(by), WideFloat(by), WideFloat(by)};
  const WidePoint low = min(corner[0], min(corner[1], corner[2])) - margin,
                  high = max(corner[0], max(corner[1], corner[2])) + margin;
  store_points(low, boxes.low);
  store_points(high, boxes.high);
  all.low[0] = reduce_min(low.x), all.low[1] = reduce_min(low.y), all.low[2] = reduce_min(low.z);
  all.high[0] = reduce_max(high.x), all.high[1] = reduce_max(high.y), all.high[2] = reduce_max(high.z);
}

// The axes are the two normals. A sliver's normal is mostly rounding and may point anywhere. This does no harm: any
// axis may separate, as long as both triangles are projected on it, because a sliver is no point on its own rounded
// normal.
//
// The error of a projection is a few roundings, 2^-24 each, of products no larger than |normal| (the sum of its
// magnitudes) times the span of the corners. kProjectionError is 67 roundings. kProjectionUnderflow covers products
// that underflow, also in programs that flush denormals to zero. Smaller: triangles that touch may count as apart.
// Larger: more pairs are tested in double.
constexpr float kProjectionError = 4e-6f;       // a share of |normal| times span
constexpr float kProjectionUnderflow = 1e-36f;  // world units, cubed

// Sixteen triangles, their normals, and their intervals on their own normals, relative to their first corners.
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

// The same in arrays, to read one triangle at a time.
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

// The distance on an axis of the interval from low to high and three projected points.
STANDOFF_INLINE WideFloat separation(const WideFloat (&points)[3], const WideFloat& low, const WideFloat& high) {
  return max(min(points[0], min(points[1], points[2])) - high, low - max(points[0], max(points[1], points[2])));
}

// The lanes, of sixteen triangles, that may be within `apart` of one lane of others.
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
    std::uint32_t near = overlapping_lanes(*a.boxes, lane_of(*b.boxes, lane)) & a.lanes;
    if (near != 0) near &= not_separated(planes, *b.triangles, others, lane, apart);
    for (; near != 0; near &= near - 1)
      pairs[count++] = {static_cast<std::uint8_t>(__builtin_ctz(near)), static_cast<std::uint8_t>(lane)};
  }
  return count;
}

// Lower bounds of the distances of sixteen spheres from a surface. The loops are plain ones, which the compiler
// vectorises, because GPU threads share the code of kernel_data.h.
void gaps_at(const FieldView& f, const float (*center)[kLanes], const float* radius, float enough, float* gap) {
  alignas(64) std::int32_t coarse_at[kLanes], tile[kLanes], within[kLanes];
  alignas(64) float coarse_off[kLanes], fine_off[kLanes], outside[kLanes];
  for (int n = 0; n < kLanes; ++n) {
    const SphereSamples at = samples_near(f, center[0][n], center[1][n], center[2][n], radius[n]);
    outside[n] = at.outside, coarse_off[n] = at.coarse_off, fine_off[n] = at.fine_off;
    coarse_at[n] = at.coarse, tile[n] = at.tile, within[n] = at.within;
  }
  alignas(64) float bound[kLanes];
  for (int n = 0; n < kLanes; ++n) bound[n] = f.coarse[coarse_at[n]];
  const WideFloat by_coarse = max(WideFloat::load(outside), WideFloat::load(bound) - WideFloat::load(coarse_off));
  by_coarse.store(gap);
  const Mask settled = less(WideFloat(enough), by_coarse);
  for (std::uint32_t asked = (~settled).to_bits(); asked != 0; asked &= asked - 1) {
    const int n = __builtin_ctz(asked);
    gap[n] = standoff::max(gap[n], static_cast<float>(fine_sample(f, tile[n], within[n])) * f.step - fine_off[n]);
  }
}

void gaps(const FieldView& f, const FloatTransform& transform, const Sphere16& spheres, float enough, float* gap) {
  alignas(64) float center[3][kLanes];
  store_points(transformed(transform, load_points(spheres.center)), center);
  gaps_at(f, center, spheres.radius, enough, gap);
}

// Pairs of triangles are decided and measured eight at a time: by triangle_overlap.h, overlap_penetration.h and
// closest_pair.h for eight doubles.

struct EightPairs {
  DoublePoint p[3], q[3];
};
STANDOFF_INLINE EightPairs transformed_pairs(const TrianglePairs& pairs, const DoubleTransform* transform_p,
                                             const DoubleTransform* transform_q) {
  EightPairs result;
  for (int k = 0; k < 3; ++k) {
    result.p[k] = load_points(pairs.p[k]), result.q[k] = load_points(pairs.q[k]);
    if (transform_p) result.p[k] = transformed(*transform_p, result.p[k]);
    if (transform_q) result.q[k] = transformed(*transform_q, result.q[k]);
  }
  return result;
}

void overlap_pairs(const TrianglePairs& pairs, const DoubleTransform* transform_p, const DoubleTransform* transform_q,
                   PairOverlaps& out) {
  const EightPairs pair = transformed_pairs(pairs, transform_p, transform_q);
  const TriangleOverlap<WideDouble> m = triangle_overlap(pair.p, pair.q);
  out.intersecting = m.intersecting.to_bits();
  out.unsure = m.unsure.to_bits();
  out.inaccurate = 0;
  if (out.intersecting == 0) return;
  const OverlapPenetration<WideDouble> c = penetration(m, pair.p, pair.q);
  out.inaccurate = out.intersecting & ~c.accurate.to_bits();
  store_points(c.point, out.point);
  store_points(c.normal, out.normal);
  c.depth.store(out.depth);
}

void closest(const TrianglePairs& pairs, const DoubleTransform* transform_p, const DoubleTransform* transform_q,
             ClosestOfPairs& out) {
  const EightPairs pair = transformed_pairs(pairs, transform_p, transform_q);
  const PairPoints<WideDouble> found = closest_pair(pair.p, pair.q);
  found.distance_sq.store(out.distance_sq);
  store_points(found.on_p, out.on_p);
  store_points(found.on_q, out.on_q);
}

}  // namespace

constexpr Kernels kTable{.name = STANDOFF_TARGET_NAME,
                         .gaps = gaps,
                         .gaps_at = gaps_at,
                         .overlapping = standoff::STANDOFF_TARGET::overlapping_lanes,
                         .obb_distances_sq = obb_distances_sq,
                         .near_triangles = near_triangles,
                         .obb_free_times = obb_free_times,
                         .obb_free_time = obb_free_time,
                         .approaching_triangles = approaching_triangles,
                         .transform_triangles = transform_triangles,
                         .close_pairs = close_pairs,
                         .overlap_pairs = overlap_pairs,
                         .closest = closest};

}  // namespace standoff::collision::STANDOFF_TARGET

const standoff::collision::Kernels standoff::collision::Kernels::STANDOFF_TARGET =
    standoff::collision::STANDOFF_TARGET::kTable;
