// SPDX-License-Identifier: Apache-2.0
// Measures in double between triangles that rounding in float cannot tell apart: eight pairs of a point and a triangle
// at a time.
#pragma once

#include "geometry/triangle_distance.h"
#include "points/cpu/kernels/node_frames.inl"

namespace standoff::cpu::STANDOFF_TARGET {
namespace {

STANDOFF_INLINE void compare_pairs(const BvhView& tree, PointGroup& points, PairTable& table) {
  constexpr int kPairs = WideDouble::kLanes;
  const int pairs = table.pair_count;
  for (int first = 0; first < pairs; first += kPairs) {
    alignas(64) double rows[3][kPairs][4];
    for (int lane = 0; lane < kPairs; ++lane) {
      const PairTable::Pair& pair = table.pairs[first + lane < pairs ? first + lane : pairs - 1];
      const std::uint32_t triangle = tree.index[pair.place];
      for (int which = 0; which < 3; ++which)
        store_local(rows[which][lane], corner_of(tree, triangle, which), points.scale, points.at[pair.point]);
    }
    const auto corner = [&](int which) __attribute__((always_inline)) {
      return DoublePoint{load_column(rows[which], 0), load_column(rows[which], 1), load_column(rows[which], 2)};
    };
    alignas(64) double sq[kPairs];
    origin_distance_sq(corner(0), corner(1), corner(2)).store(sq);
    for (int lane = 0; lane < kPairs && first + lane < pairs; ++lane) {
      const PairTable::Pair& pair = table.pairs[first + lane];
      const std::uint32_t triangle = tree.index[pair.place];
      double& best = points.nearest_sq[pair.point];
      if (sq[lane] > best || (sq[lane] == best && triangle >= points.nearest[pair.point])) continue;
      best = sq[lane];
      points.nearest[pair.point] = triangle;
    }
  }
  table.pair_count = 0;
}

STANDOFF_INLINE void add_pair(const BvhView& tree, std::uint32_t place, int point, PointGroup& points,
                              PairTable& table) {
  if (table.pair_count == PairTable::kMostPairs) compare_pairs(tree, points, table);
  table.pairs[table.pair_count++] = {place, static_cast<std::uint32_t>(point)};
}

}  // namespace
}  // namespace standoff::cpu::STANDOFF_TARGET
