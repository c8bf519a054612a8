// The kernels that decide and measure pairs of triangles, eight at a time: triangle_overlap.h, crossing.h and
// closest_pair.h for eight doubles.
#pragma once

#include "collision/cpu/kernels/target.inl"
#include "geometry/closest_pair.h"
#include "geometry/crossing.h"

namespace standoff::collision::STANDOFF_TARGET {
namespace {

using DoublePoints = Triple<WideDouble>;

STANDOFF_INLINE DoublePoints load_points(const double (&at)[3][kPairs]) {
  return {WideDouble::load(at[0]), WideDouble::load(at[1]), WideDouble::load(at[2])};
}
STANDOFF_INLINE void store_points(const DoublePoints& points, double (&at)[3][kPairs]) {
  points.x.store(at[0]), points.y.store(at[1]), points.z.store(at[2]);
}

struct EightPairs {
  DoublePoints p[3], q[3];
};
STANDOFF_INLINE EightPairs placed_pairs(const TrianglePairs& pairs, const DoublePlace* place_p,
                                        const DoublePlace* place_q) {
  EightPairs result;
  for (int k = 0; k < 3; ++k) {
    result.p[k] = load_points(pairs.p[k]), result.q[k] = load_points(pairs.q[k]);
    if (place_p) result.p[k] = placed(*place_p, result.p[k]);
    if (place_q) result.q[k] = placed(*place_q, result.q[k]);
  }
  return result;
}

void meet(const TrianglePairs& pairs, const DoublePlace* place_p, const DoublePlace* place_q, Meetings& out) {
  const EightPairs pair = placed_pairs(pairs, place_p, place_q);
  const Meeting<WideDouble> m = meeting(pair.p, pair.q);
  out.touching = m.touch.to_bits();
  out.unsure = m.unsure.to_bits();
  out.inaccurate = 0;
  if (out.touching == 0) return;
  const Crossing<WideDouble> c = crossing(m, pair.p, pair.q);
  out.inaccurate = out.touching & ~c.accurate.to_bits();
  store_points(c.point, out.point);
  store_points(c.normal, out.normal);
  c.depth.store(out.depth);
}

void closest(const TrianglePairs& pairs, const DoublePlace* place_p, const DoublePlace* place_q, ClosestOfPairs& out) {
  const EightPairs pair = placed_pairs(pairs, place_p, place_q);
  const PairPoints<WideDouble> found = closest_pair(pair.p, pair.q);
  found.distance_sq.store(out.distance_sq);
  store_points(found.on_p, out.on_p);
  store_points(found.on_q, out.on_q);
}

}  // namespace
}  // namespace standoff::collision::STANDOFF_TARGET
