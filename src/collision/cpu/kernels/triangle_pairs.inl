// SPDX-License-Identifier: Apache-2.0
// The kernels that decide and measure pairs of triangles, eight at a time: triangle_overlap.h, overlap_penetration.h
// and closest_pair.h for eight doubles.
#pragma once

#include "collision/cpu/kernels/target.inl"
#include "geometry/closest_pair.h"
#include "geometry/overlap_penetration.h"

namespace standoff::collision::STANDOFF_TARGET {
namespace {

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
}  // namespace standoff::collision::STANDOFF_TARGET
