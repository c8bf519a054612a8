// SPDX-License-Identifier: Apache-2.0
// The kernels that look for the box nearest to a point, by the boxes' centres, and for a point of a triangle in it.
#pragma once

#include "field/cpu/box_arrays.h"
#include "field/cpu/kernels/target.inl"
#include "geometry/triangle_distance.h"
#include "simd/points.inl"

namespace standoff::cpu::STANDOFF_TARGET {
namespace {

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

// Plane by plane of the lattice: the squared distances are sums of numbers that the points of a row or column share.
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

int nearest_in_pack(const PackContents& pack, const float* point) {
  WideFloat distance_sq(0);
  for (int axis = 0; axis < 3; ++axis) {
    const WideFloat twice =
        WideFloat::load(pack.boxes->low[axis]) + WideFloat::load(pack.boxes->high[axis]) - WideFloat(2 * point[axis]);
    distance_sq = fma(twice, twice, distance_sq);
  }
  const Mask used = mask_from_bits((1u << pack.count) - 1);
  distance_sq = select(used, distance_sq, WideFloat(__builtin_inff()));
  return static_cast<int>(nearest_position({distance_sq, lane_numbers()}));
}

}  // namespace
}  // namespace standoff::cpu::STANDOFF_TARGET
