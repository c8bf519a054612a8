// SPDX-License-Identifier: Apache-2.0
// The frame of a large triangle, ready for points far closer together than the triangle is wide.
//
// Frame coordinates of a point in the middle of a triangle 1000 samples wide are of the order of 1000, too coarse in
// float. What the distance depends on is where the point lies against each line of the triangle, and near a line that
// is a small number. So each such number gets a linear function of its own, made in double and rounded last: it is
// coarse only where it is large, and there either it is clamped away or the distance is large as well.
#pragma once

#include "geometry/triangle_frame.h"

namespace standoff {

/// The lines of one right triangle: past its base's end, across and along its hypotenuse.
template <class F>
struct HalfLines {
  Linear<F> past, across, along;  // along measures from the base's end
  F along_apex;                   // the constant of `along` measured from the apex
};

template <class F>
struct TriangleLines {
  Linear<F> q, y, z;
  HalfLines<F> left, right;
};

/// From a frame in double to lines in F (float).
template <class F>
STANDOFF_INLINE Linear<F> rounded(const Linear<double>& f) {
  return {{F(static_cast<float>(f.g.x)), F(static_cast<float>(f.g.y)), F(static_cast<float>(f.g.z))},
          F(static_cast<float>(f.c))};
}

STANDOFF_INLINE Linear<double> combined(double a, const Linear<double>& f, double b, const Linear<double>& g) {
  return {f.g * a + g.g * b, f.c * a + g.c * b};
}

template <class F>
STANDOFF_INLINE HalfLines<F> half_lines(double towards, const TriangleFrame<double>& f,
                                        const HalfTriangle<double>& half) {
  Linear<double> past{f.q.g * towards, f.q.c * towards - half.leg};
  const Linear<double> along = combined(half.nx, f.y, -half.ny, past);
  return {rounded<F>(past), rounded<F>(combined(half.nx, past, half.ny, f.y)), rounded<F>(along),
          F(static_cast<float>(along.c - half.length))};
}

template <class F>
STANDOFF_INLINE TriangleLines<F> make_lines(const TriangleFrame<double>& f) {
  return {rounded<F>(f.q), rounded<F>(f.y), rounded<F>(f.z), half_lines<F>(-1, f, f.left),
          half_lines<F>(1, f, f.right)};
}

/// What the lines read at a point; `along` without its constant.
template <class F>
struct LineReadings {
  F q, y, z, past_left, across_left, along_left, past_right, across_right, along_right;
};

template <class F>
STANDOFF_INLINE F lines_distance_sq(const TriangleLines<F>& t, const LineReadings<F>& at) {
  const auto is_left = less(at.q, F(0));
  const F along = select(is_left, at.along_left, at.along_right);
  const F t0 = along + select(is_left, t.left.along.c, t.right.along.c);
  const F t1 = along + select(is_left, t.left.along_apex, t.right.along_apex);
  return combined_distance_sq(at.z, select(is_left, at.across_left, at.across_right), t0, t1,
                              select(is_left, at.past_left, at.past_right), at.y);
}

template <class F>
STANDOFF_INLINE F distance_sq(const TriangleLines<F>& t, const Triple<F>& p) {
  const F zero(0);
  return lines_distance_sq(
      t, LineReadings<F>{evaluate(t.q, p), evaluate(t.y, p), evaluate(t.z, p), evaluate(t.left.past, p),
                         evaluate(t.left.across, p), evaluate(Linear<F>{t.left.along.g, zero}, p),
                         evaluate(t.right.past, p), evaluate(t.right.across, p),
                         evaluate(Linear<F>{t.right.along.g, zero}, p)});
}

/// The same for a point that lies in `half` of the triangle, left of the altitude or right of it: the same bits.
template <class F>
STANDOFF_INLINE F distance_sq_in_half(const TriangleLines<F>& t, const HalfLines<F>& half, const Triple<F>& p) {
  const F along = evaluate(Linear<F>{half.along.g, F(0)}, p);
  return combined_distance_sq(evaluate(t.z, p), evaluate(half.across, p), along + half.along.c, along + half.along_apex,
                              evaluate(half.past, p), evaluate(t.y, p));
}

}  // namespace standoff
