// SPDX-License-Identifier: Apache-2.0
// Distance from points to a triangle in the triangle's own frame, without branches.
//
// The frame. x runs along the longest edge AB, y along the altitude to the third corner C, z along the normal; the
// origin is the altitude's foot, which lies on AB because AB is the longest edge. The altitude cuts the triangle into
// two right triangles. The closest point of a point with x < 0 lies in the left one, else in the right one: were it on
// the other side, the segment to it would cross the altitude, or pass the apex where the normals of both edges lean
// away. Mirrored to x >= 0, a right triangle has the corners (0,0), (leg,0), (0,height).
//
// The distance. For a point (q, y, z) with q >= 0 let s and t be its coordinates across and along the hypotenuse, from
// (leg,0), and l the hypotenuse's length. Two lower bounds of the squared distance in the plane are
//   e = max(s,0)^2 + (t - clamp(t,0,l))^2     against the hypotenuse, exact for y >= 0
//   f = max(q - leg,0)^2 + min(y,0)^2         against the base, exact for y <= 0
// f never exceeds the distance since the triangle lies in q <= leg and y >= 0; e never does since it measures to the
// half plane below the hypotenuse cut by the strip 0 <= t <= l, which holds the right triangle. So max(e, f) is exact
// everywhere.
//
// Degenerate triangles need no special case: a segment has height 0, a point has legs 0 as well, and any orthonormal
// frame serves them.
//
// Error: all is computed in F from corners relative to a nearby reference point; with corners and points within R of it
// the distance is within 32 R epsilon(F) (tests/geometry/triangle_frame_test.cpp measures it on random and on
// needle-like triangles).
#pragma once

#include "geometry/triple.h"

namespace standoff {

/// A linear function of a point: c + g . p.
template <class F>
struct Linear {
  Triple<F> g;
  F c;
};

/// One of the two right triangles: its leg on the base, and length and unit normal of its hypotenuse.
template <class F>
struct HalfTriangle {
  F leg, length, nx, ny;
};

template <class F>
struct TriangleFrame {
  Linear<F> q, y, z;  // coordinates of a point in the frame
  HalfTriangle<F> left, right;
};

/// The larger of two numbers that are not NaN, and of which either zero will do.
template <class F>
STANDOFF_INLINE F larger(const F& a, const F& b) {
  return max(a, b);
}
STANDOFF_INLINE float larger(float a, float b) { return STANDOFF_LARGER(a, b); }

/// The last step of all evaluations: the squared distance from z, the coordinate across the hypotenuse (s), the
/// coordinates along it from both ends (t0 from the base, t1 from the apex), the distance past the base's end (past),
/// and y.
template <class F>
STANDOFF_INLINE F combined_distance_sq(const F& z, const F& s, const F& t0, const F& t1, const F& past, const F& y) {
  const F zero(0);
  const F beside = max(s, zero);
  const F beyond = min(t0, zero) + max(t1, zero);
  const F outside = max(past, zero);
  const F below = min(y, zero);
  const F hypotenuse_sq = fma(beside, beside, beyond * beyond);
  const F base_sq = fma(outside, outside, below * below);
  return fma(z, z, larger(hypotenuse_sq, base_sq));
}

/// The squared distance of the point whose frame coordinates are (q, y, z).
template <class F>
STANDOFF_INLINE F frame_distance_sq(const TriangleFrame<F>& f, const F& q, const F& y, const F& z) {
  const auto is_left = less(q, F(0));
  const F leg = select(is_left, f.left.leg, f.right.leg);
  const F length = select(is_left, f.left.length, f.right.length);
  const F nx = select(is_left, f.left.nx, f.right.nx);
  const F ny = select(is_left, f.left.ny, f.right.ny);
  const F past = abs(q) - leg;
  const F s = fma(nx, past, ny * y);
  const F t = fma(nx, y, F(-(ny * past)));
  return combined_distance_sq(z, s, t, F(t - length), past, y);
}

template <class F>
STANDOFF_INLINE F evaluate(const Linear<F>& f, const Triple<F>& p) {
  return fma(p.x, f.g.x, fma(p.y, f.g.y, fma(p.z, f.g.z, f.c)));
}

/// The squared distance of point p, which is relative to the same reference as the frame's corners.
template <class F>
STANDOFF_INLINE F distance_sq(const TriangleFrame<F>& f, const Triple<F>& p) {
  return frame_distance_sq(f, evaluate(f.q, p), evaluate(f.y, p), evaluate(f.z, p));
}

/// The point of the triangle closest to p, relative to the same reference.
template <class F>
STANDOFF_INLINE Triple<F> closest_in_frame(const TriangleFrame<F>& f, const Triple<F>& p) {
  const F zero(0);
  const F q = evaluate(f.q, p), y = evaluate(f.y, p), z = evaluate(f.z, p);
  const auto is_left = less(q, zero);
  const F leg = select(is_left, f.left.leg, f.right.leg), length = select(is_left, f.left.length, f.right.length);
  const F nx = select(is_left, f.left.nx, f.right.nx), ny = select(is_left, f.left.ny, f.right.ny);
  const F past = abs(q) - leg;
  const F across = fma(nx, past, ny * y);
  const F along = min(max(fma(nx, y, F(-(ny * past))), zero), length);
  // The point is on the hypotenuse if p lies beyond it, else p's projection if p is inside, else on the base. Without a
  // leg, the hypotenuse is upright, and p may lie on its line above the apex, which is nx * length high.
  const auto beyond = less(zero, across);
  const F x_inside = min(abs(q), leg), y_inside = min(max(y, zero), F(nx * length));
  const F x = select(beyond, max(fma(F(-ny), along, leg), zero), x_inside);
  const F mirrored = select(is_left, F(-x), x);
  const F height = select(beyond, max(nx * along, zero), y_inside);
  const Triple<F> in_base = f.q.g * F(mirrored - q) + f.y.g * F(height - y);
  return p + in_base + f.z.g * F(-z);
}

/// v / |v|, or `fallback` if |v|^2 is not above `least_sq`.
template <class F>
STANDOFF_INLINE Triple<F> unit_or(const Triple<F>& v, const F& length_sq, const F& least_sq,
                                  const Triple<F>& fallback) {
  const auto usable = less(least_sq, length_sq);
  const F inverse = F(1) / sqrt(select(usable, length_sq, F(1)));
  return select(usable, v * inverse, fallback);
}

/// A unit vector perpendicular to the unit vector u: the axis with the least component of u, made orthogonal to it.
template <class F>
STANDOFF_INLINE Triple<F> any_perpendicular(const Triple<F>& u) {
  const F zero(0), one(1);
  const F ax = abs(u.x), ay = abs(u.y), az = abs(u.z);
  const auto x_least_of_xy = less(ax, ay);
  const Triple<F> of_xy = select(x_least_of_xy, Triple<F>{one, zero, zero}, Triple<F>{zero, one, zero});
  const Triple<F> axis = select(less(az, min(ax, ay)), Triple<F>{zero, zero, one}, of_xy);
  const Triple<F> v = minus_scaled(axis, u, dot(axis, u));
  return v * (F(1) / sqrt(dot(v, v)));
}

/// A component of a unit vector, corrected to exactly 1 or -1 if the others are zero.
template <class F>
STANDOFF_INLINE F alone_or(const F& component, const F& others) {
  const F zero(0), one(1);
  const F sign = select(less(component, zero), F(-one), select(less(zero, component), one, zero));
  return select(less(zero, others), component, sign);
}

/// The same for a vector. So a point in the plane of a triangle that is perpendicular to an axis has exactly the
/// distance 0 from that plane.
template <class F>
STANDOFF_INLINE Triple<F> exact_along_axes(const Triple<F>& v) {
  const F ax = abs(v.x), ay = abs(v.y), az = abs(v.z);
  return {alone_or(v.x, F(ay + az)), alone_or(v.y, F(az + ax)), alone_or(v.z, F(ax + ay))};
}

template <class F>
STANDOFF_INLINE HalfTriangle<F> half_triangle(const F& leg, const F& height) {
  const F length_sq = fma(leg, leg, height * height);
  // Rounding may leave heights of 1e-22, whose squares have lost most of their digits. 1e-36 is a normal float.
  const auto usable = less(F(1e-36f), length_sq);
  const F length = sqrt(length_sq);
  const F inverse = F(1) / select(usable, length, F(1));
  return {leg, length, select(usable, height * inverse, F(1)), leg * inverse};
}

/// The frame of the triangle a, b, c. `least_sq` is the squared length below which an edge or altitude counts as zero:
/// small compared with the accuracy wanted, large compared with underflow.
template <class F>
STANDOFF_INLINE TriangleFrame<F> make_frame(const Triple<F>& a, const Triple<F>& b, const Triple<F>& c,
                                            const F& least_sq) {
  // Rotate the corners so that the first edge is the longest. If two are equally long, either will do, but not the
  // third, which may have no direction.
  const F ab = dot(b - a, b - a), bc = dot(c - b, c - b), ca = dot(a - c, a - c);
  const auto ca_longest = less(max(ab, bc), ca);
  const auto ab_shorter = less(ab, max(bc, ca));
  const Triple<F> start = select(ca_longest, c, select(ab_shorter, b, a));
  const Triple<F> end = select(ca_longest, a, select(ab_shorter, c, b));
  const Triple<F> apex = select(ca_longest, b, select(ab_shorter, a, c));

  const F zero(0), one(1);
  const Triple<F> base = end - start;
  const F base_sq = dot(base, base);
  const Triple<F> ux = unit_or(base, base_sq, least_sq, Triple<F>{one, zero, zero});
  const F base_length = dot(base, ux);

  // Make the altitude orthogonal to the base twice: one pass leaves the frame of a needle askew by 1e-3, two by 1e-7.
  const Triple<F> side = apex - start;
  const F foot = max(zero, min(dot(side, ux), base_length));
  const Triple<F> once = minus_scaled(side, ux, dot(side, ux));
  const Triple<F> altitude = minus_scaled(once, ux, dot(once, ux));
  const F altitude_sq = dot(altitude, altitude);
  const Triple<F> uy = unit_or(altitude, altitude_sq, least_sq, any_perpendicular(ux));
  const Triple<F> uz = exact_along_axes(cross(ux, uy));
  const F height = dot(altitude, uy);

  TriangleFrame<F> frame;
  frame.q = {ux, F(-dot(start, ux)) - foot};
  frame.y = {uy, F(-dot(start, uy))};
  frame.z = {uz, F(-dot(start, uz))};
  frame.left = half_triangle(foot, max(height, zero));
  frame.right = half_triangle(max(base_length - foot, zero), max(height, zero));
  return frame;
}

// Lines are the frame of a large triangle, for points far closer together than the triangle is wide.
//
// Frame coordinates of a point in the middle of a triangle 1000 samples wide are of the order of 1000, too coarse in
// float. But the distance only depends on the point's distance from each line of the triangle, which is a small number
// near the line. So each of these numbers gets its own linear function, made in double and rounded last: it is coarse
// only where it is large, and there either it is clamped or the distance is large as well.

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

/// Makes lines in F (float) from a frame in double.
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

/// The values of the lines at a point; `along` without its constant.
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

/// The same, with the same bits, for a point that lies in `half` of the triangle, left or right of the altitude.
template <class F>
STANDOFF_INLINE F distance_sq_in_half(const TriangleLines<F>& t, const HalfLines<F>& half, const Triple<F>& p) {
  const F along = evaluate(Linear<F>{half.along.g, F(0)}, p);
  return combined_distance_sq(evaluate(t.z, p), evaluate(half.across, p), along + half.along.c, along + half.along_apex,
                              evaluate(half.past, p), evaluate(t.y, p));
}

}  // namespace standoff
