// SPDX-License-Identifier: Apache-2.0
// The penetration of two intersecting triangles (point, normal and depth) from the numbers of their test
// (triangle_overlap.h), for double and for eight doubles at once.
#pragma once

#include "geometry/triangle_overlap.h"

namespace standoff {

template <class F>
struct OverlapPenetration {
  Triple<F> point;   ///< the middle of the segment that both share
  Triple<F> normal;  ///< unit length: moving q along it by `depth` separates them
  F depth;
  FlagsOf<F> accurate;  ///< whether all errors are at most 1e-9 of the pair's extent
};

/// If a triangle is a sliver, or an edge grazes the other's plane, rounding moves the point: by 8 roundings of the
/// extent, divided by two sines, of the angle between the two edges that make the normal and of the angle between edge
/// and plane. Neither may be below this.
inline constexpr double kLeastSine = 1e-3;

template <class F>
STANDOFF_INLINE FlagsOf<F> is_accurate(const TriangleOverlap<F>& m, const Triple<F> (&p)[3], const Triple<F> (&q)[3]) {
  const F p_normal_sq = plain_dot(m.p_normal, m.p_normal), q_normal_sq = plain_dot(m.q_normal, m.q_normal),
          least_sq(kLeastSine * kLeastSine);
  const auto squared = [](const Triple<F>& v) __attribute__((always_inline)) { return plain_dot(v, v); };
  const auto fat = [&](const Triple<F>(&t)[3], const F& normal_sq) __attribute__((always_inline)) {
    return less(least_sq * squared(t[1] - t[0]) * squared(t[2] - t[0]), normal_sq);
  };
  const auto steep = [&](const F& from, const F& to, const Triple<F>& edge, const F& normal_sq)
      __attribute__((always_inline)) {
    const F drop = from - to;
    return less(least_sq * squared(edge) * normal_sq, drop * drop);
  };
  const FlagsOf<F> p_fat = fat(p, p_normal_sq), q_fat = fat(q, q_normal_sq);
  const FlagsOf<F> a_steep[2] = {steep(m.a.height[0], m.a.height[1], m.a1, q_normal_sq),
                                 steep(m.a.height[0], m.a.height[2], m.a2, q_normal_sq)};
  const FlagsOf<F> b_steep[2] = {steep(m.b.height[0], m.b.height[1], m.b1 - m.b0, p_normal_sq),
                                 steep(m.b.height[0], m.b.height[2], m.b2 - m.b0, p_normal_sq)};
  return p_fat & q_fat & a_steep[0] & a_steep[1] & b_steep[0] & b_steep[1];
}

/// The middle of the segment that both share: it lies between the second and the third of the four points at which
/// edges pass through the planes' common line.
template <class F>
STANDOFF_INLINE Triple<F> middle_of_shared(const TriangleOverlap<F>& m) {
  const Triple<F> along = plain_cross(m.p_normal, m.q_normal);
  Triple<F> at[4] = {m.a1 * (m.a.height[0] / (m.a.height[0] - m.a.height[1])),
                     m.a2 * (m.a.height[0] / (m.a.height[0] - m.a.height[2])),
                     m.b0 + (m.b1 - m.b0) * (m.b.height[0] / (m.b.height[0] - m.b.height[1])),
                     m.b0 + (m.b2 - m.b0) * (m.b.height[0] / (m.b.height[0] - m.b.height[2]))};
  F position[4] = {plain_dot(along, at[0]), plain_dot(along, at[1]), plain_dot(along, at[2]), plain_dot(along, at[3])};
  const auto ordered = [&](int i, int j) __attribute__((always_inline)) {
    const FlagsOf<F> swap = less(position[j], position[i]);
    const Triple<F> low = select(swap, at[j], at[i]), high = select(swap, at[i], at[j]);
    const F least_position = select(swap, position[j], position[i]),
            most_position = select(swap, position[i], position[j]);
    at[i] = low, at[j] = high, position[i] = least_position, position[j] = most_position;
  };
  ordered(0, 1);
  ordered(2, 3);
  ordered(0, 2);  // now 2 is the later of the two first points
  ordered(1, 3);  // and 1 the earlier of the two last ones
  return m.a.corner[0] + (at[1] + at[2]) * F(0.5);
}

/// Requires that the triangles intersect for certain.
template <class F>
STANDOFF_INLINE OverlapPenetration<F> penetration(const TriangleOverlap<F>& m, const Triple<F> (&p)[3],
                                                  const Triple<F> (&q)[3]) {
  OverlapPenetration<F> c;
  c.accurate = is_accurate(m, p, q);
  c.point = middle_of_shared(m);
  // Along p's normal p itself is flat, as it is no sliver, and so is q along its own: the translation that separates
  // them there has the length of the other triangle's extent beyond the plane.
  const F p_size = F(1) / sqrt(plain_dot(m.p_normal, m.p_normal)),
          q_size = F(1) / sqrt(plain_dot(m.q_normal, m.q_normal));
  const Triple<F> p_unit = m.p_normal * p_size, q_unit = m.q_normal * q_size;
  c.depth = -min(m.q_height[0], min(m.q_height[1], m.q_height[2])) * p_size;
  c.normal = p_unit;
  const auto keep_shallower = [&c](const F& depth, const Triple<F>& direction) __attribute__((always_inline)) {
    const FlagsOf<F> shallower = less(depth, c.depth);
    c.depth = select(shallower, depth, c.depth);
    c.normal = select(shallower, direction, c.normal);
  };
  keep_shallower(max(m.q_height[0], max(m.q_height[1], m.q_height[2])) * p_size, p_unit * F(-1));
  keep_shallower(max(m.p_height[0], max(m.p_height[1], m.p_height[2])) * q_size, q_unit);
  keep_shallower(-min(m.p_height[0], min(m.p_height[1], m.p_height[2])) * q_size, q_unit * F(-1));
  return c;
}

}  // namespace standoff
