// SPDX-License-Identifier: Apache-2.0
// The point of a triangle that is closest to the origin, by the region of the triangle that the origin lies over
// (Ericson, Real-Time Collision Detection, 5.1.5). A third of the work of closest_part(), for triangles that are wide
// enough.
//
// With R the distance of the farthest corner, s the longest side, h the altitude on it and e the unit of rounding, a
// cross product errs by a few R s e; so a weight does by a few R / h e, and the point in the triangle's plane by s
// times that. A region that is wrong for its rounding moves the point by no more, because regions meet where their
// points do. So the answer is sound where h is no small share of R; nor is it near the surface, where what the point is
// off by is much beside the way to it.
#pragma once

#include "geometry/triple.h"

namespace standoff {

template <class F>
struct QuickPart {
  Triple<F> point;
  Triple<F> weights;  ///< of the three corners
  F feature;          ///< as a number of enum Feature: 0 the face, 1 to 3 edges, 4 to 6 vertices
  F distance_sq;
};

/// Returns the mask of the answers that are sound. Those are off by 1e-12 R, their weights by 1e-12.
template <class F>
STANDOFF_INLINE auto quick_part(const Triple<F>& a, const Triple<F>& b, const Triple<F>& c, QuickPart<F>& part) {
  constexpr double kLeastHeight = 0x1p-10, kLeastDistance = 1e-6;  // as shares of R
  constexpr double kLeastAreaSq = 1e-200, kMostSq = 0x1p180;       // squares of squares are normal numbers
  const F zero(0.0), one(1.0);
  const Triple<F> ab = b - a, ac = c - a;
  const F ab_sq = dot(ab, ab), ac_sq = dot(ac, ac), between = dot(ab, ac);
  // Where the foot on each edge is, from one end and from the other, times the length of the edge.
  const F on_ab = -dot(ab, a), on_ac = -dot(ac, a);
  const F of_ba = ab_sq - on_ab, of_ca = ac_sq - on_ac;
  const F on_bc = (on_ac - between) + of_ba, of_cb = (on_ab - between) + of_ca;
  // Twice the areas that the foot makes with each edge, times the length of the normal.
  const Triple<F> normal = cross(ab, ac);
  const F area_b = dot(normal, cross(ac, a)), area_c = dot(normal, cross(a, ab)), area = dot(normal, normal);
  const F area_a = area - area_b - area_c;

  // On the borders between the regions, as where rounding leaves none, there is no answer.
  const auto at_a = less(max(on_ab, on_ac), zero), at_b = less(max(of_ba, on_bc), zero),
             at_c = less(max(of_ca, of_cb), zero);
  const auto is_ab = less(area_c, zero) & less(zero, min(on_ab, of_ba)),
             is_ca = less(area_b, zero) & less(zero, min(on_ac, of_ca)),
             is_bc = less(area_a, zero) & less(zero, min(on_bc, of_cb));
  const auto is_face = less(zero, min(area_a, min(area_b, area_c)));

  // Shares of the corners: of the face, unless they lie on an edge or a corner.
  F of_a = area_a, of_b = area_b, of_c = area_c, all = area, feature = zero;
  const auto take = [&](const auto& where, const F& share_a, const F& share_b, const F& share_c, const F& sum,
                        double number) __attribute__((always_inline)) {
    of_a = select(where, share_a, of_a);
    of_b = select(where, share_b, of_b);
    of_c = select(where, share_c, of_c);
    all = select(where, sum, all);
    feature = select(where, F(number), feature);
  };
  const F bc_sq = on_bc + of_cb;
  take(is_ab, of_ba, on_ab, zero, ab_sq, 1);
  take(is_bc, zero, of_cb, on_bc, bc_sq, 2);
  take(is_ca, of_ca, zero, on_ac, ac_sq, 3);
  take(at_c, zero, zero, one, one, 6);
  take(at_b, zero, one, zero, one, 5);
  take(at_a, one, zero, zero, one, 4);
  const F share = one / all;
  part.weights = {min(of_a * share, one), min(of_b * share, one), min(of_c * share, one)};
  const F v = part.weights.y, w = part.weights.z;
  part.point = {fma(ab.x, v, fma(ac.x, w, a.x)), fma(ab.y, v, fma(ac.y, w, a.y)), fma(ab.z, v, fma(ac.z, w, a.z))};
  part.distance_sq = dot(part.point, part.point);
  part.feature = feature;

  const F farthest_sq = max(dot(a, a), max(dot(b, b), dot(c, c)));
  const F side_sq = max(ab_sq, max(ac_sq, bc_sq));
  return (at_a | at_b | at_c | is_ab | is_bc | is_ca | is_face) & less(farthest_sq, F(kMostSq)) &
         less(max(side_sq * farthest_sq * F(kLeastHeight * kLeastHeight), F(kLeastAreaSq)), area) &
         less(farthest_sq * F(kLeastDistance * kLeastDistance), part.distance_sq);
}

}  // namespace standoff
