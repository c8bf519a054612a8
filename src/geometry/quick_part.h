// SPDX-License-Identifier: Apache-2.0
// The point of a triangle that is closest to the origin, by the region of the triangle that the origin lies over
// (Ericson, Real-Time Collision Detection, 5.1.5). A third of the work of closest_part(), for triangles that are wide
// enough; less where several points are near one triangle, which is prepared once.
//
// With R the distance of the farthest corner, s the longest side, h the altitude on it and e the unit of rounding, the
// normal errs by a few s s e, so a weight does by a few R / h s / h e. A region that is wrong for its rounding moves
// the point by no more, because regions meet where their points do. So the answer is sound where h is no small share of
// R; nor is it near the surface, where what the point is off by is much beside the way to it.
#pragma once

#include "geometry/triple.h"

namespace standoff {

/// Closer points than this share of R, squared, may be on the surface.
inline constexpr double kQuickLeastDistanceSq = 1e-12;

/// Whether answers are sound: the altitude on the longest side is no small share of R, and squares of squares are
/// normal numbers. Of twice the area, the longest side and 2 R R, all squared but the last.
template <class F>
STANDOFF_INLINE auto is_wide_enough(const F& area_sq, const F& side_sq, const F& far_sq) {
  constexpr double kLeastHeight = 0x1p-10, kLeastAreaSq = 1e-200, kMostSq = 0x1p180;
  return less(far_sq, F(kMostSq)) &
         less(max(side_sq * far_sq * F(kLeastHeight * kLeastHeight), F(kLeastAreaSq)), area_sq);
}

/// What quick_part() knows of a triangle, wherever the point is.
template <class F>
struct QuickTriangle {
  Triple<F> ab, ac;
  Triple<F> to_b, to_c;            ///< along which the weights of b and c grow, times area_sq
  F ab_sq, ac_sq, bc_sq, between;  ///< the sides' squares, and dot(ab, ac)
  F area_sq;                       ///< of twice the area
  F side_sq;                       ///< of the longest side
};

template <class F>
STANDOFF_INLINE QuickTriangle<F> quick_triangle(const Triple<F>& a, const Triple<F>& b, const Triple<F>& c) {
  QuickTriangle<F> t;
  t.ab = b - a, t.ac = c - a;
  const Triple<F> bc = c - b, normal = cross(t.ab, t.ac);
  t.ab_sq = dot(t.ab, t.ab), t.ac_sq = dot(t.ac, t.ac), t.bc_sq = dot(bc, bc), t.between = dot(t.ab, t.ac);
  t.to_b = cross(t.ac, normal), t.to_c = cross(normal, t.ab);
  t.area_sq = dot(normal, normal);
  t.side_sq = max(t.ab_sq, max(t.ac_sq, t.bc_sq));
  return t;
}

/// The closest point of a triangle, relative to the point asked. `Where` is a mask: in one of the seven regions, if
/// the answer is sound.
template <class F, class Where>
struct QuickPart {
  Where at_a, at_b, at_c, is_ab, is_bc, is_ca;
  Where is_sound;  ///< off by 1e-12 R, and the weights by 1e-12
  F v, w;          ///< the weights of b and c
  Triple<F> point;
  F distance_sq;
};

/// Of the point that is `p` away from the triangle's first corner.
template <class F>
STANDOFF_INLINE auto quick_part(const QuickTriangle<F>& t, const Triple<F>& p) {
  const F zero(0.0), one(1.0);
  QuickPart<F, decltype(less(zero, one))> part;
  // Where the foot on each edge is, from one end and from the other, times the length of the edge.
  const F on_ab = dot(t.ab, p), on_ac = dot(t.ac, p);
  const F of_ba = t.ab_sq - on_ab, of_ca = t.ac_sq - on_ac;
  const F on_bc = (on_ac - t.between) + of_ba, of_cb = (on_ab - t.between) + of_ca;
  // Weights of the foot on the plane, times area_sq.
  const F of_b = dot(t.to_b, p), of_c = dot(t.to_c, p), of_a = (t.area_sq - of_b) - of_c;

  // On the borders between the regions, as where rounding leaves none, there is no answer.
  part.at_a = less(max(on_ab, on_ac), zero);
  part.at_b = less(max(of_ba, on_bc), zero);
  part.at_c = less(max(of_ca, of_cb), zero);
  part.is_ab = less(of_c, zero) & less(zero, min(on_ab, of_ba));
  part.is_bc = less(of_a, zero) & less(zero, min(on_bc, of_cb));
  part.is_ca = less(of_b, zero) & less(zero, min(on_ac, of_ca));
  const auto is_face = less(zero, min(of_a, min(of_b, of_c)));

  // Shares of b and c, and what they are shares of. At the corners they are known.
  const F all = select(part.is_ab, t.ab_sq, select(part.is_bc, t.bc_sq, select(part.is_ca, t.ac_sq, t.area_sq)));
  const F share = one / all;
  const F v = min(select(part.is_bc, of_cb, select(part.is_ab, on_ab, of_b)) * share, one);
  const F w = min(select(part.is_bc, on_bc, select(part.is_ca, on_ac, of_c)) * share, one);
  part.v = select(part.at_b, one, select(part.at_a | part.is_ca | part.at_c, zero, v));
  part.w = select(part.at_c, one, select(part.at_a | part.is_ab | part.at_b, zero, w));
  const auto along = [&](const F& ab, const F& ac, const F& from) __attribute__((always_inline)) {
    return fma(ab, part.v, fma(ac, part.w, F(-from)));
  };
  part.point = {along(t.ab.x, t.ac.x, p.x), along(t.ab.y, t.ac.y, p.y), along(t.ab.z, t.ac.z, p.z)};
  part.distance_sq = dot(part.point, part.point);

  const F far_sq = (dot(p, p) + t.side_sq) * F(2.0);  // R R at most
  part.is_sound = (part.at_a | part.at_b | part.at_c | part.is_ab | part.is_bc | part.is_ca | is_face) &
                  is_wide_enough(t.area_sq, t.side_sq, far_sq) &
                  less(far_sq * F(kQuickLeastDistanceSq), part.distance_sq);
  return part;
}

/// Of the three corners. Those that the feature says are zero are.
template <class F, class Where>
STANDOFF_INLINE Triple<F> weights_of(const QuickPart<F, Where>& part) {
  const F of_a = (F(1.0) - part.v) - part.w;
  return {select(part.is_bc | part.at_b | part.at_c, F(0.0), of_a), part.v, part.w};
}

/// What the point lies on, as a number of enum Feature: 0 the face, 1 to 3 edges, 4 to 6 vertices.
template <class F, class Where>
STANDOFF_INLINE F feature_of(const QuickPart<F, Where>& part) {
  F feature(0.0);
  const auto is = [&](const Where& where, double number) __attribute__((always_inline)) {
    feature = select(where, F(number), feature);
  };
  is(part.is_ab, 1), is(part.is_bc, 2), is(part.is_ca, 3);
  is(part.at_a, 4), is(part.at_b, 5), is(part.at_c, 6);
  return feature;
}

}  // namespace standoff
