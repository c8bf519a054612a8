// SPDX-License-Identifier: Apache-2.0
// Decides whether two triangles intersect, as far as double precision can decide it: without branches, for double and
// for eight doubles at once. After Guigue and Devillers, Fast and robust triangle-triangle overlap test using
// orientation predicates (2003).
//
// If neither triangle has all corners on one side of the other's plane, both cross the line in which the planes
// intersect. Let a0 be the corner of p that is alone on its side of q's plane: the edges a0 a1 and a0 a2 pass the line
// at two points, and so do b0 b1 and b0 b2. The triangles intersect unless both points of one come before both points
// of the other. The sign of det(a_i - a0, b0 - a0, b_j - a0) decides which of two points comes first: with a0 = A - s u
// and b0 = B - t w, u and w the edges' directions and A and B the points, it is the sign of (u x w).(A - B) or its
// negative; and since both edges from a0 pass to the same side, and so do both from b0, it is the same case for all
// four pairs.
//
// The error of a determinant is at most 7e-16 times the sum of its products' magnitudes (Shewchuk's first stage). There
// are six products, none larger than the product of the extents. Determinants within that error are left to exact
// predicates.
#pragma once

#include "geometry/closest_pair.h"
#include "geometry/rounding.h"
#include "geometry/triple.h"

namespace standoff {

/// The result of less(): bool, or a mask.
template <class F>
using FlagsOf = decltype(less(F(), F()));

STANDOFF_INLINE bool negated(bool flag) { return !flag; }

/// A transformed point, with the same roundings as apply() for poses: so all answers are about the same corners.
template <class F>
STANDOFF_INLINE F transformed_row(const double* row, double translation, const Triple<F>& at) {
  return F(row[0]) * at.x + F(row[1]) * at.y + F(row[2]) * at.z + F(translation);
}
template <class F>
STANDOFF_INLINE Triple<F> transformed(const DoubleTransform& transform, const Triple<F>& at) {
  const double *const r = transform.rotation, *const t = transform.translation;
  return {transformed_row(r, t[0], at), transformed_row(r + 3, t[1], at), transformed_row(r + 6, t[2], at)};
}

/// The signs of numbers whose magnitude exceeds a bound.
template <class F>
struct Signs {
  FlagsOf<F> positive, negative;
};
template <class F>
STANDOFF_INLINE Signs<F> signs(const F& value, const F& bound) {
  return {less(bound, value), less(value, F(-bound))};
}

/// A triangle and its signs about the other's plane, rotated so that its first corner is alone on its side.
template <class F>
struct Turned {
  Triple<F> corner[3];
  F height[3];
  FlagsOf<F> sure, apart;  ///< whether all signs are certain; whether all corners are on one side
};
template <class F>
STANDOFF_INLINE Turned<F> turn(const Triple<F> (&corner)[3], const F (&height)[3], const F& bound) {
  const Signs<F> s[3] = {signs(height[0], bound), signs(height[1], bound), signs(height[2], bound)};
  Turned<F> t;
  t.sure = (s[0].positive | s[0].negative) & (s[1].positive | s[1].negative) & (s[2].positive | s[2].negative);
  t.apart = (s[0].positive & s[1].positive & s[2].positive) | (s[0].negative & s[1].negative & s[2].negative);
  const FlagsOf<F> first = negated(s[1].positive ^ s[2].positive), second = negated(s[0].positive ^ s[2].positive);
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3, last = (k + 2) % 3;
    t.corner[k] = select(first, corner[k], select(second, corner[next], corner[last]));
    t.height[k] = select(first, height[k], select(second, height[next], height[last]));
  }
  return t;
}

/// The extent of the corners of a pair along an axis.
template <class F>
STANDOFF_INLINE F extent(const Triple<F> (&p)[3], const Triple<F> (&q)[3], F Triple<F>::*axis) {
  return max(max(p[0].*axis, max(p[1].*axis, p[2].*axis)), max(q[0].*axis, max(q[1].*axis, q[2].*axis))) -
         min(min(p[0].*axis, min(p[1].*axis, p[2].*axis)), min(q[0].*axis, min(q[1].*axis, q[2].*axis)));
}

/// The answer and its intermediate numbers, from which overlap_penetration.h finds the point of contact.
template <class F>
struct TriangleOverlap {
  FlagsOf<F> intersecting, unsure;  ///< they intersect for certain; rounding may hide the answer
  Triple<F> p_normal, q_normal;
  F p_height[3], q_height[3];    ///< the heights of corners over the other's plane, times the length of its normal
  Turned<F> a, b;                ///< p and q
  Triple<F> a1, a2, b0, b1, b2;  ///< their corners relative to a's first corner
};
template <class F>
STANDOFF_INLINE TriangleOverlap<F> triangle_overlap(const Triple<F> (&p)[3], const Triple<F> (&q)[3]) {
  constexpr double kRounding = 6e-15;
  const F bound =
      extent(p, q, &Triple<F>::x) * extent(p, q, &Triple<F>::y) * extent(p, q, &Triple<F>::z) * F(kRounding) +
      F(kUnderflowOf3d);
  TriangleOverlap<F> m;
  m.p_normal = plain_cross(p[1] - p[0], p[2] - p[0]), m.q_normal = plain_cross(q[1] - q[0], q[2] - q[0]);
  for (int k = 0; k < 3; ++k)
    m.p_height[k] = plain_dot(m.q_normal, p[k] - q[0]), m.q_height[k] = plain_dot(m.p_normal, q[k] - p[0]);
  m.a = turn(p, m.p_height, bound), m.b = turn(q, m.q_height, bound);

  // Decide the order of a's and b's points on the common line.
  m.a1 = m.a.corner[1] - m.a.corner[0], m.a2 = m.a.corner[2] - m.a.corner[0];
  m.b0 = m.b.corner[0] - m.a.corner[0], m.b1 = m.b.corner[1] - m.a.corner[0], m.b2 = m.b.corner[2] - m.a.corner[0];
  const Triple<F> m1 = plain_cross(m.b0, m.b1), m2 = plain_cross(m.b0, m.b2);
  const Signs<F> order[4] = {signs(plain_dot(m.a1, m1), bound), signs(plain_dot(m.a1, m2), bound),
                             signs(plain_dot(m.a2, m1), bound), signs(plain_dot(m.a2, m2), bound)};
  const FlagsOf<F> before = order[0].positive | order[1].positive | order[2].positive | order[3].positive;
  const FlagsOf<F> after = order[0].negative | order[1].negative | order[2].negative | order[3].negative;
  const FlagsOf<F> all_before = order[0].positive & order[1].positive & order[2].positive & order[3].positive;
  const FlagsOf<F> all_after = order[0].negative & order[1].negative & order[2].negative & order[3].negative;
  const FlagsOf<F> sure = m.a.sure & m.b.sure;
  const FlagsOf<F> apart = m.a.apart | m.b.apart | (sure & (all_before | all_after));
  m.intersecting = sure & negated(apart) & before & after;
  m.unsure = negated(apart | m.intersecting);
  return m;
}

}  // namespace standoff
