// SPDX-License-Identifier: Apache-2.0
// The point of a triangle that is closest to the origin, its barycentric coordinates, and what part of the triangle it
// lies on: without branches, for double and for eight doubles at once. No operation is fused.
//
// Candidates are the closest points of the three edges, and the foot of the perpendicular if it is inside. Each is a
// point of the triangle, whatever rounding does to needles: the nearest one counts, and an edge goes before the face.
// So a distance is never too small. It is too large by a few 1e-16 of the largest corner's distance, or where that is
// less, of the triangle's width.
#pragma once

#include "geometry/closest_pair.h"

namespace standoff {

template <class F>
struct ClosestPart {
  Triple<F> point;
  Triple<F> weights;  ///< of the three corners
  F feature;          ///< as a number of enum Feature: 0 the face, 1 to 3 edges, 4 to 6 vertices
  F distance_sq;
  Triple<F> normal;  ///< of the triangle; its length is twice the area
  F side_sq;         ///< of the longest side
};

/// The closest point of the edge from corner `k` at `a` to the next one at `b`.
template <int k, class F>
STANDOFF_INLINE void look_at_edge(const Triple<F>& a, const Triple<F>& b, ClosestPart<F>& best) {
  constexpr int next = (k + 1) % 3;
  const F zero(0.0), one(1.0);
  const Triple<F> edge = b - a;
  const F length_sq = plain_dot(edge, edge);
  const auto has_length = less(zero, length_sq);
  const F along = F(-plain_dot(a, edge)) / select(has_length, length_sq, one);
  const F share = select(has_length, min(max(along, zero), one), zero);
  const auto after_start = less(zero, share), before_end = less(share, one);
  const Triple<F> point = select(before_end, a + edge * share, b);
  const F distance_sq = plain_dot(point, point);
  const auto nearer = less(distance_sq, best.distance_sq);

  best.distance_sq = select(nearer, distance_sq, best.distance_sq);
  best.point = select(nearer, point, best.point);
  const F of_a = one - share;
  best.weights = select(nearer,
                        Triple<F>{k == 0      ? of_a
                                  : next == 0 ? share
                                              : zero,
                                  k == 1      ? of_a
                                  : next == 1 ? share
                                              : zero,
                                  k == 2      ? of_a
                                  : next == 2 ? share
                                              : zero},
                        best.weights);
  const F part = select(after_start, select(before_end, F(1.0 + k), F(4.0 + next)), F(4.0 + k));
  best.feature = select(nearer, part, best.feature);
  best.side_sq = max(length_sq, best.side_sq);
}

template <class F>
STANDOFF_INLINE const Triple<F>& weights_of(const ClosestPart<F>& part) {
  return part.weights;
}
template <class F>
STANDOFF_INLINE const F& feature_of(const ClosestPart<F>& part) {
  return part.feature;
}

template <class F>
STANDOFF_INLINE ClosestPart<F> closest_part(const Triple<F>& a, const Triple<F>& b, const Triple<F>& c) {
  const F zero(0.0), one(1.0);
  const Triple<F> nothing{zero, zero, zero};
  ClosestPart<F> best{nothing, nothing, zero, F(__builtin_inf()), plain_cross(b - a, c - a), zero};
  look_at_edge<0>(a, b, best);
  look_at_edge<1>(b, c, best);
  look_at_edge<2>(c, a, best);

  // Twice the areas that the foot makes with each edge, times the normal's length.
  const F of_a = plain_dot(best.normal, plain_cross(b, c)), of_b = plain_dot(best.normal, plain_cross(c, a)),
          of_c = plain_dot(best.normal, plain_cross(a, b));
  const auto inside = less(zero, min(of_a, min(of_b, of_c)));
  const F inverse = one / select(inside, of_a + of_b + of_c, one);
  const Triple<F> weights{of_a * inverse, of_b * inverse, of_c * inverse};
  const Triple<F> foot = a * weights.x + b * weights.y + c * weights.z;
  const F foot_sq = plain_dot(foot, foot);
  const auto nearer = inside & less(foot_sq, best.distance_sq);
  best.distance_sq = select(nearer, foot_sq, best.distance_sq);
  best.point = select(nearer, foot, best.point);
  best.weights = select(nearer, weights, best.weights);
  best.feature = select(nearer, zero, best.feature);
  return best;
}

/// The direction in which the distance grows at the origin; for points within 1e-9 of the longest side, the unit normal
/// times `orientation` (1 or -1), or, for an orientation of 0, the unit normal on the origin's side. (0, 0, 1) there if
/// the triangle has no area that can be told from rounding.
template <class F>
struct Slope {
  Triple<F> direction;
  F is_near;  ///< 1 where the point counts as one of the surface, else 0
};
template <class F>
STANDOFF_INLINE Slope<F> slope_of(const ClosestPart<F>& part, const Triple<F>& corner, const F& orientation) {
  constexpr double kNearSq = 1e-18, kLeastAreaSq = 1e-30;
  const F zero(0.0), one(1.0);
  const auto is_far = less(part.side_sq * F(kNearSq), part.distance_sq);
  const F away = F(-1.0) / sqrt(select(is_far, part.distance_sq, one));

  const F normal_sq = plain_dot(part.normal, part.normal);
  const auto has_area = less(part.side_sq * part.side_sq * F(kLeastAreaSq), normal_sq);
  const F side = select(less(zero, plain_dot(part.normal, corner)), F(-1.0), one);
  const F of_normal =
      select(less(zero, orientation * orientation), orientation, side) / sqrt(select(has_area, normal_sq, one));
  const Triple<F> near = select(has_area, part.normal * of_normal, Triple<F>{zero, zero, one});
  return {select(is_far, part.point * away, near), select(is_far, zero, one)};
}

}  // namespace standoff
