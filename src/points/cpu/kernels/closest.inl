// SPDX-License-Identifier: Apache-2.0
// The kernel that finds the closest points of the nearest triangles.
#pragma once

#include "geometry/triangle_distance.h"
#include "points/cpu/kernels.h"
#include "simd/points.inl"
#include "standoff/feature.h"

namespace standoff::cpu::STANDOFF_TARGET {

using namespace standoff::STANDOFF_TARGET;

namespace {

// Requires that no coordinate is NaN.
STANDOFF_INLINE DoubleMask equal(const DoublePoint& a, const DoublePoint& b) {
  return negated(less(a.x, b.x) | less(b.x, a.x) | less(a.y, b.y) | less(b.y, a.y) | less(a.z, b.z) | less(b.z, a.z));
}

STANDOFF_INLINE WideDouble number_of(Feature feature) { return WideDouble(static_cast<double>(feature)); }

void closest(ClosestOfEight& eight) {
  const WideDouble zero(0.0), one(1.0);
  const DoublePoint corners[3] = {load_points(eight.corners[0]), load_points(eight.corners[1]),
                                  load_points(eight.corners[2])};
  // Find the nearest edge, and the closest point on it as a weight of each end.
  WideDouble best_sq(__builtin_inf());
  DoublePoint best = corners[0], from = corners[0], to = corners[1];
  DoubleMask is_side[3] = {double_mask_from_bits(0xff), double_mask_from_bits(0), double_mask_from_bits(0)};
  for (int n = 0; n < 3; ++n) {
    const DoublePoint &begin = corners[n], &end = corners[(n + 1) % 3];
    const DoublePoint q = nearest_on_edge(begin, end);
    const WideDouble sq = dot(q, q);
    const DoubleMask nearer = less(sq, best_sq);
    best_sq = select(nearer, sq, best_sq);
    best = select(nearer, q, best);
    from = select(nearer, begin, from);
    to = select(nearer, end, to);
    for (int side = 0; side < n; ++side) is_side[side] = is_side[side] & negated(nearer);
    is_side[n] = is_side[n] | nearer;
  }
  const DoubleMask at_from = equal(best, from), at_to = equal(best, to) & negated(at_from);
  const DoublePoint along = to - from;
  const WideDouble unbound = dot(best - from, along) / dot(along, along);
  const WideDouble share = select(less(unbound, zero), zero, select(less(one, unbound), one, unbound));
  const WideDouble of_from = select(at_from, one, select(at_to, zero, one - share)),
                   of_to = select(at_from, zero, select(at_to, one, share));
  // Take the face instead where the projection is inside it and nearer.
  const NearestInside<WideDouble> inside = nearest_inside(corners[0], corners[1], corners[2]);
  const DoublePoint face = point_inside(inside, corners[0], corners[1], corners[2]);
  const DoubleMask on_face = less(zero, inside.least) & less(dot(face, face), best_sq);
  store_points(select(on_face, face, best), eight.point);
  // Write weights and features.
  WideDouble feature = number_of(Feature::face);
  for (int n = 0; n < 3; ++n) {
    const int before = (n + 2) % 3;
    const WideDouble on_edge = select(is_side[n], of_from, select(is_side[before], of_to, zero));
    select(on_face, inside.across[n] / inside.sum, on_edge).store(eight.weights[n]);
    const WideDouble edge(static_cast<double>(Feature::edge0) + n), vertex(static_cast<double>(Feature::vertex0) + n);
    const DoubleMask at_vertex = (is_side[n] & at_from) | (is_side[before] & at_to);
    feature = select(is_side[n] & negated(at_from | at_to), edge, select(at_vertex, vertex, feature));
  }
  select(on_face, number_of(Feature::face), feature).store(eight.feature);
}

}  // namespace
}  // namespace standoff::cpu::STANDOFF_TARGET
