// SPDX-License-Identifier: Apache-2.0
// The kernels that cull boxes of triangles.
//
// With the cell's centre as origin, its half extents h and a point q of the surface, a box that holds the nearest point
// p of some sample x must have |x-p|^2 < |x-q|^2, that is |p|^2 - |q|^2 < 2 x.(p-q). The right side is at most
// 2 sum h_a |p_a - q_a| over the cell, so the box is culled if
//     sum over axes a of min over p_a in the box of (p_a^2 - 2 h_a |p_a - q_a|)  >=  |q|^2.
// The axes separate. On one axis -|d| is the smaller of -d and d, and the two parabolas p^2 - 2hp + 2hq and
// p^2 + 2hp - 2hq have their least values at p = h and p = -h, clamped to the box. Apart from +-2hq these do not depend
// on q, so many points q cost little more than one. Far from a flat sheet, with q nearest to the cell's corners, this
// test keeps the patch under the cell; comparing distances keeps a disc that grows with the distance.
#pragma once

#include "field/cpu/kernels.h"
#include "field/cpu/kernels/triangle_frames.inl"
#include "geometry/triangle_distance.h"
#include "simd/points.inl"

namespace standoff::cpu::STANDOFF_TARGET {
namespace {

// The margin that raises |q|^2, as a share of |q|^2 + |h|^2 + kLeastCellSq. The rounding of the sum is below 2e-6 of
// that. The rest, 1e-5 |q| of distance, covers the error of the float distances that the gather computes: so culling
// changes no bit. With a smaller margin it may; a larger one keeps more boxes.
constexpr float kCullMargin = 2e-5f;
// Squared grid units: keeps the margin above zero for a cell of one sample, whose half extents are 0, with q near it.
constexpr float kLeastCellSq = 4;

// The least values of p^2 - 2hp and of p^2 + 2hp over low <= p <= high.
struct LeastOnAxis {
  WideFloat plus, minus;
};
STANDOFF_INLINE LeastOnAxis least_on_axis(const WideFloat& low, const WideFloat& high, float half) {
  const WideFloat h(half), twice(2 * half);
  const WideFloat a = min(max(h, low), high), b = min(max(-h, low), high);
  return {a * (a - twice), b * (b + twice)};
}

// A reference in the form of the test: 2 h_a q_a, and |q|^2 with its margin.
struct CullReference {
  float shift[3];
  float limit;
};

// Whether boxes, relative to the cell's centre, can hold a point nearer to some sample than every reference is.
STANDOFF_INLINE Mask may_beat(const WidePoint& low, const WidePoint& high, const float* half,
                              const CullReference* references, int count, Mask among) {
  const LeastOnAxis x = least_on_axis(low.x, high.x, half[0]), y = least_on_axis(low.y, high.y, half[1]),
                    z = least_on_axis(low.z, high.z, half[2]);
  for (int n = 0; n < count && among.to_bits() != 0; ++n) {
    const CullReference& r = references[n];
    const WideFloat sx(r.shift[0]), sy(r.shift[1]), sz(r.shift[2]);
    const WideFloat sum =
        min(x.plus + sx, x.minus - sx) + min(y.plus + sy, y.minus - sy) + min(z.plus + sz, z.minus - sz);
    among = among & ~less(WideFloat(r.limit), sum);
  }
  return among;
}

// A lower bound of the squared distance between the cell's samples and boxes, relative to the cell's centre.
STANDOFF_INLINE WideFloat gap_sq(const WidePoint& low, const WidePoint& high, const float* half) {
  const WideFloat zero(0);
  const auto gap = [&](const WideFloat& l, const WideFloat& h, float extent) __attribute__((always_inline)) {
    return max(max(l - WideFloat(extent), -h - WideFloat(extent)), zero);
  };
  const WideFloat x = gap(low.x, high.x, half[0]), y = gap(low.y, high.y, half[1]), z = gap(low.z, high.z, half[2]);
  return fma(x, x, fma(y, y, z * z));
}

// A cell and its references in the form of the tests.
struct Culling {
  WidePoint center;
  const float* half;
  WideFloat reach_sq;
  bool is_limited;  // whether the reach is finite
  CullReference references[References::kMost];
  int count;
};

STANDOFF_INLINE Culling culling(const CullCell& cell, const References& references) {
  Culling c;
  c.center = {WideFloat(cell.center[0]), WideFloat(cell.center[1]), WideFloat(cell.center[2])};
  c.half = cell.half;
  c.reach_sq = WideFloat(cell.reach * cell.reach * (1 + kSlackRatio) + kSlack * kSlack);
  c.is_limited = cell.reach < __builtin_inff();
  c.count = references.count;
  const float half_sq = cell.half[0] * cell.half[0] + cell.half[1] * cell.half[1] + cell.half[2] * cell.half[2];
  for (int n = 0; n < references.count; ++n) {
    float q_sq = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const float q = references.at[n][axis] - cell.center[axis];
      c.references[n].shift[axis] = 2 * cell.half[axis] * q;
      q_sq += q * q;
    }
    c.references[n].limit = q_sq + kCullMargin * (q_sq + half_sq + kLeastCellSq);
  }
  return c;
}

// Adds the boxes, of sixteen, that are within reach and may beat the references.
STANDOFF_INLINE void keep_some(const Culling& c, const WidePoint& low, const WidePoint& high, const WideUint& entries,
                               int used, BoxArrays& kept) {
  const WidePoint l = low - c.center, h = high - c.center;
  Mask in_reach = mask_from_bits((1u << used) - 1);
  if (c.is_limited) in_reach = in_reach & ~less(c.reach_sq, gap_sq(l, h, c.half));
  const Mask keep = may_beat(l, h, c.half, c.references, c.count, in_reach);
  if (keep.to_bits() == 0) return;
  const WideFloat* const sides[6] = {&low.x, &low.y, &low.z, &high.x, &high.y, &high.z};
  for (int axis = 0; axis < 3; ++axis) {
    store_packed(kept.low[axis] + kept.count, keep, *sides[axis]);
    store_packed(kept.high[axis] + kept.count, keep, *sides[3 + axis]);
  }
  kept.count += store_packed(kept.entry + kept.count, keep, entries);
}

void cull_boxes(const BoxArrays& boxes, const CullCell& cell, const References& references, BoxArrays& kept) {
  const Culling c = culling(cell, references);
  for (std::int64_t first = 0; first < boxes.count; first += kLanes) {
    const int used = boxes.count - first < kLanes ? static_cast<int>(boxes.count - first) : kLanes;
    const auto load = [&](float* const* side) __attribute__((always_inline)) {
      return WidePoint{WideFloat::load(side[0] + first), WideFloat::load(side[1] + first),
                       WideFloat::load(side[2] + first)};
    };
    keep_some(c, load(boxes.low), load(boxes.high), WideUint::load(boxes.entry + first), used, kept);
  }
}

void cull_nodes(const BvhNode* nodes, std::int64_t count, const CullCell& cell, const References& references,
                BoxArrays& kept) {
  const Culling c = culling(cell, references);
  for (std::int64_t n = 0; n < count; ++n) {
    const Boxes16& boxes = *nodes[n].boxes;
    const auto load = [&](const float(&side)[3][kLanes]) __attribute__((always_inline)) {
      return WidePoint{WideFloat::load(side[0]), WideFloat::load(side[1]), WideFloat::load(side[2])};
    };
    keep_some(c, load(boxes.low), load(boxes.high), WideUint(nodes[n].first) + lane_numbers(), nodes[n].count, kept);
  }
}

// The kernels that find the box whose centre is nearest to a point, and the closest point of a triangle in it.

// The nearest box so far, lane by lane.
struct NearestBox {
  WideFloat distance_sq{__builtin_inff()};
  WideUint position{0u};
};

STANDOFF_INLINE std::uint32_t nearest_position(const NearestBox& found) {
  alignas(64) std::uint32_t positions[kLanes];
  found.position.store(positions);
  return positions[__builtin_ctz(equal(found.distance_sq, WideFloat(reduce_min(found.distance_sq))).to_bits())];
}

// Visits the lattice plane by plane: the squared distances are sums of numbers that the points of a row or column
// share.
void nearest_to_lattice(const BoxArrays& boxes, const float (&at)[3][kLatticeSide], std::uint32_t* nearest) {
  constexpr int kPlane = kLatticeSide * kLatticeSide;
  const WideFloat infinity(__builtin_inff());
  for (int k = 0; k < kLatticeSide; ++k) {
    NearestBox found[kPlane];
    WideUint position = lane_numbers();
    for (std::int64_t first = 0; first < boxes.count; first += kLanes, position = position + WideUint(kLanes)) {
      const auto off_sq = [&](int axis, int n) __attribute__((always_inline)) {
        const WideFloat twice = WideFloat::load(boxes.low[axis] + first) + WideFloat::load(boxes.high[axis] + first) -
                                WideFloat(2 * at[axis][n]);
        return twice * twice;
      };
      WideFloat x_sq[kLatticeSide], y_sq[kLatticeSide], z_sq = off_sq(2, k);
      for (int n = 0; n < kLatticeSide; ++n) {
        x_sq[n] = off_sq(0, n);
        y_sq[n] = off_sq(1, n);
      }
      const std::int64_t left = boxes.count - first;
      if (left < kLanes) z_sq = select(mask_from_bits((1u << left) - 1), z_sq, infinity);
      for (int j = 0; j < kLatticeSide; ++j) {
        const WideFloat yz_sq = y_sq[j] + z_sq;
        for (int i = 0; i < kLatticeSide; ++i) {
          NearestBox& best = found[i + kLatticeSide * j];
          const WideFloat d = x_sq[i] + yz_sq;
          best.position = select(less(d, best.distance_sq), position, best.position);
          best.distance_sq = min(d, best.distance_sq);
        }
      }
    }
    for (int n = 0; n < kPlane; ++n) nearest[n + kPlane * k] = nearest_position(found[n]);
  }
}

void nearest_on_triangles(TriangleLanes& lanes) {
  const DoublePoint at = load_points(lanes.at);
  const DoublePoint a = load_points(lanes.corner[0]) - at, b = load_points(lanes.corner[1]) - at,
                    c = load_points(lanes.corner[2]) - at;
  DoublePoint best = nearest_on_edge(a, b);
  const auto look = [&](const DoubleMask& where, const DoublePoint& q) __attribute__((always_inline)) {
    best = select(where & less(dot(q, q), dot(best, best)), q, best);
  };
  const DoubleMask always = less(WideDouble(0), WideDouble(1));
  look(always, nearest_on_edge(b, c));
  look(always, nearest_on_edge(c, a));
  const NearestInside<WideDouble> inside = nearest_inside(a, b, c);
  look(less(WideDouble(0), inside.least), point_inside(inside, a, b, c));
  store_points(best + at, lanes.at);
}

int nearest_child(const BvhNode& node, const float* point) {
  WideFloat distance_sq(0);
  for (int axis = 0; axis < 3; ++axis) {
    const WideFloat twice =
        WideFloat::load(node.boxes->low[axis]) + WideFloat::load(node.boxes->high[axis]) - WideFloat(2 * point[axis]);
    distance_sq = fma(twice, twice, distance_sq);
  }
  const Mask used = mask_from_bits((1u << node.count) - 1);
  distance_sq = select(used, distance_sq, WideFloat(__builtin_inff()));
  return static_cast<int>(nearest_position({distance_sq, lane_numbers()}));
}

}  // namespace
}  // namespace standoff::cpu::STANDOFF_TARGET
