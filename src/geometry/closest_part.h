// SPDX-License-Identifier: Apache-2.0
// The point of a triangle that is closest to the origin, its barycentric coordinates, and its feature: face, edge or
// vertex. It has no branches, and works for double and for eight doubles at once. No operations are fused.
//
// Candidates are the closest points of the three edges, and the foot of the perpendicular if it is inside. Each is a
// point of the triangle, whatever rounding does to needles. The nearest one counts; an edge wins a tie with the face.
// So a distance is never too small. It is too large by at most a few 1e-16 of the farthest corner's distance, or of the
// triangle's width if that is less.
#pragma once

#include "geometry/closest_pair.h"
#include "geometry/triple.h"

namespace standoff {

template <class F>
struct ClosestPart {
  Triple<F> point;
  Triple<F> weights;  ///< the weights of the three corners
  F feature;          ///< a number of enum Feature: 0 the face, 1 to 3 edges, 4 to 6 vertices
  F distance_sq;
  Triple<F> normal;  ///< the triangle's normal; its length is twice the area
  F side_sq;         ///< the square of the longest side
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

  // Compute twice the areas of the triangles of the foot and each edge, times the normal's length.
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

/// The direction in which the distance grows at the origin. For points nearer than 1e-9 of the longest side it is the
/// unit normal times `orientation` (1 or -1), or, if `orientation` is 0, the unit normal on the origin's side; and
/// (0, 0, 1) if the triangle's area is no larger than rounding.
template <class F>
struct Slope {
  Triple<F> direction;
  F is_near;  ///< 1 if the point counts as on the surface, else 0
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

// The same by the region of the triangle that the origin lies over (Ericson, Real-Time Collision Detection, 5.1.5), for
// triangles that are wide enough. It takes a third of the work of closest_part(), and less if several points are near
// one triangle, which is prepared once.
//
// Let R be the distance of the farthest corner, s the longest side, h the altitude on it and e the unit of rounding.
// The error of the normal is a few s s e, so the error of a weight is a few R / h s / h e. If rounding picks a wrong
// region, the point moves by no more, because regions meet where their points do. So the answer is sound if h is no
// small share of R. It is not sound near the surface, where the point's error is large compared with its distance.

/// Points with a smaller squared distance than this share of R R may be on the surface.
inline constexpr double kQuickLeastDistanceSq = 1e-12;

/// Whether answers are sound: the altitude on the longest side is no small share of R, and squares of squares are
/// normal numbers. The arguments are the squares of twice the area and of the longest side, and 2 R R.
template <class F>
STANDOFF_INLINE auto is_wide_enough(const F& area_sq, const F& side_sq, const F& far_sq) {
  constexpr double kLeastHeight = 0x1p-10, kLeastAreaSq = 1e-200, kMostSq = 0x1p180;
  return less(far_sq, F(kMostSq)) &
         less(max(side_sq * far_sq * F(kLeastHeight * kLeastHeight), F(kLeastAreaSq)), area_sq);
}

/// A triangle prepared for quick_part().
template <class F>
struct QuickTriangle {
  Triple<F> ab, ac;
  Triple<F> to_b, to_c;            ///< the gradients of the weights of b and c, times area_sq
  F ab_sq, ac_sq, bc_sq, between;  ///< the squares of the sides, and dot(ab, ac)
  F area_sq;                       ///< the square of twice the area
  F side_sq;                       ///< the square of the longest side
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

/// The closest point of a triangle, relative to the query point. `Where` is a mask. If the answer is sound, exactly one
/// of the seven regions is set.
template <class F, class Where>
struct QuickPart {
  Where at_a, at_b, at_c, is_ab, is_bc, is_ca;
  Where is_sound;  ///< the error of the point is at most 1e-12 R, of the weights 1e-12
  F v, w;          ///< the weights of b and c
  Triple<F> point;
  F distance_sq;
};

/// The part for the point at `p` from the triangle's first corner.
template <class F>
STANDOFF_INLINE auto quick_part(const QuickTriangle<F>& t, const Triple<F>& p) {
  const F zero(0.0), one(1.0);
  QuickPart<F, decltype(less(zero, one))> part;
  // Find the foot on the line of each edge: its distances from both ends, times the length of the edge.
  const F on_ab = dot(t.ab, p), on_ac = dot(t.ac, p);
  const F of_ba = t.ab_sq - on_ab, of_ca = t.ac_sq - on_ac;
  const F on_bc = (on_ac - t.between) + of_ba, of_cb = (on_ab - t.between) + of_ca;
  // Find the weights of the foot on the plane, times area_sq.
  const F of_b = dot(t.to_b, p), of_c = dot(t.to_c, p), of_a = (t.area_sq - of_b) - of_c;

  // Find the region. On the borders between regions, and where rounding leaves no region, there is no answer.
  part.at_a = less(max(on_ab, on_ac), zero);
  part.at_b = less(max(of_ba, on_bc), zero);
  part.at_c = less(max(of_ca, of_cb), zero);
  part.is_ab = less(of_c, zero) & less(zero, min(on_ab, of_ba));
  part.is_bc = less(of_a, zero) & less(zero, min(on_bc, of_cb));
  part.is_ca = less(of_b, zero) & less(zero, min(on_ac, of_ca));
  const auto is_face = less(zero, min(of_a, min(of_b, of_c)));

  // Find the weights of b and c as quotients with the denominator `all`. At the corners they are constants.
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

  const F far_sq = (dot(p, p) + t.side_sq) * F(2.0);  // at least R R
  part.is_sound = (part.at_a | part.at_b | part.at_c | part.is_ab | part.is_bc | part.is_ca | is_face) &
                  is_wide_enough(t.area_sq, t.side_sq, far_sq) &
                  less(far_sq * F(kQuickLeastDistanceSq), part.distance_sq);
  return part;
}

/// The weights of the three corners. A weight is exactly zero if the feature implies it.
template <class F, class Where>
STANDOFF_INLINE Triple<F> weights_of(const QuickPart<F, Where>& part) {
  const F of_a = (F(1.0) - part.v) - part.w;
  return {select(part.is_bc | part.at_b | part.at_c, F(0.0), of_a), part.v, part.w};
}

/// The feature that the point lies on, a number of enum Feature: 0 the face, 1 to 3 edges, 4 to 6 vertices.
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

// The same for points over the inside of the triangle, nine in ten of a band's samples. Weights, and the height over
// the plane, are linear functions of the point: so a triangle that is nearest to several points is prepared once, and
// each point takes few operations. quick_part() handles all other points; its bounds hold here too.

/// A triangle prepared for quick_face_at().
template <class F>
struct QuickFace {
  Triple<F> to_b, to_c;  ///< the gradients of the weights of b and c; zero if no answer is sound
  Triple<F> normal;      ///< the unit normal
  F least_sq;            ///< a point is off the surface if the square of its height is more
};

/// Prepares a triangle for points whose squared distance from `a` is at most `reach_sq`.
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

// Of a tile's samples, CPU and GPU prepare the same triangles, as far as the same bound: so the bits are the same.

/// Whether one more triangle of a tile is to be prepared, after `triangles` of them have `samples` samples together.
/// Triangles come in the order of their first samples. Stops where eight or more have fewer than five each on average.
STANDOFF_INLINE bool prepares_more(int triangles, int samples) {
  constexpr int kTriangles = 8, kLeastSamples = 5;
  return triangles < kTriangles || samples >= kLeastSamples * triangles;
}

/// An upper bound of the squared distance between a point and the samples of a tile, whose corners are given.
template <class F>
STANDOFF_INLINE F reach_sq(const Triple<F>& low, const Triple<F>& high, const Triple<F>& point) {
  const F x = max(point.x - low.x, high.x - point.x), y = max(point.y - low.y, high.y - point.y),
          z = max(point.z - low.z, high.z - point.z);
  return x * x + y * y + z * z;
}

/// The answer for a point.
template <class F, class Where>
struct QuickFaceAt {
  Where is_inside;  ///< whether the point is over the inside, and the rest is sound
  F v, w;           ///< the weights of b and c
  F height;         ///< the height over the plane
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
