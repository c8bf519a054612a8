// SPDX-License-Identifier: Apache-2.0
// The closest point of a triangle to points over its inside: of a band's samples, nine in ten. Weights, and the height
// over the plane, are linear in the place, so that a triangle that is nearest to several points is prepared once, and
// each of them takes few operations. All other points are left to quick_part(), whose bounds hold here too.
#pragma once

#include "geometry/quick_part.h"

namespace standoff {

/// What quick_face_at() knows of a triangle.
template <class F>
struct QuickFace {
  Triple<F> to_b, to_c;  ///< how the weights of b and c grow with the place; zero where nothing is sound
  Triple<F> normal;      ///< of length 1
  F least_sq;            ///< points are told from the surface where the square of their height is more
};

/// Of a triangle, for points whose distance from `a`, squared, is no more than `reach_sq`.
template <class F>
STANDOFF_INLINE QuickFace<F> quick_face(const Triple<F>& a, const Triple<F>& b, const Triple<F>& c, const F& reach_sq) {
  const F zero(0.0), one(1.0);
  const Triple<F> ab = b - a, ac = c - a, bc = c - b, normal = cross(ab, ac), nothing{zero, zero, zero};
  const F area_sq = dot(normal, normal), side_sq = max(dot(ab, ab), max(dot(ac, ac), dot(bc, bc)));
  const F far_sq = (reach_sq + side_sq) * F(2.0);
  const auto is_sound = is_wide_enough(area_sq, side_sq, far_sq);
  const F inverse = one / select(is_sound, area_sq, one);
  QuickFace<F> face;
  face.to_b = select(is_sound, cross(ac, normal) * inverse, nothing);
  face.to_c = select(is_sound, cross(normal, ab) * inverse, nothing);
  face.normal = normal * sqrt(inverse);
  face.least_sq = far_sq * F(kQuickLeastDistanceSq);
  return face;
}

/// Of a point.
template <class F, class Where>
struct QuickFaceAt {
  Where is_inside;  ///< the point is over the inside, and the rest is sound
  F v, w;           ///< the weights of b and c
  F height;         ///< over the plane
};

/// Of the point that is `p` away from the triangle's first corner.
template <class F>
STANDOFF_INLINE auto quick_face_at(const QuickFace<F>& face, const Triple<F>& p) {
  QuickFaceAt<F, decltype(less(p.x, p.y))> at;
  at.v = dot(face.to_b, p), at.w = dot(face.to_c, p), at.height = dot(face.normal, p);
  const F of_a = (F(1.0) - at.v) - at.w;
  at.is_inside = less(F(0.0), min(of_a, min(at.v, at.w))) & less(face.least_sq, at.height * at.height);
  return at;
}

}  // namespace standoff
