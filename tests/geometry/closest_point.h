// SPDX-License-Identifier: Apache-2.0
// The closest point of a triangle, in world coordinates, by the regions of its corners, edges and face
// (Ericson, Real-Time Collision Detection, 2005, section 5.1.5).
//
// Ericson's formulation from dot products alone cancels twice; here the barycentric coordinates come from the normal,
// which costs three cross products and keeps one order of magnitude more on needle-like triangles.
//
// Degenerate triangles: the face is only taken when all three barycentric coordinates are positive, which no triangle
// without area gives except by rounding; then the point is still one of the triangle. Distances measured to the result
// are therefore never too small (up to rounding). They are at most too large by the width of the triangle where that is
// lost in rounding; triangle_distance.h measures them too.
#pragma once

#include "geometry/triple.h"

namespace standoff {

/// The closest point to p on the segment ab; a when the segment has no length.
template <class F>
STANDOFF_INLINE Triple<F> closest_on_segment(const Triple<F>& p, const Triple<F>& a, const Triple<F>& b) {
  const Triple<F> ab = b - a;
  const F along = dot(p - a, ab);
  const F length_sq = dot(ab, ab);
  if (!(along > F(0))) return a;
  if (along >= length_sq) return b;
  return a + ab * (along / length_sq);
}

/// The closest point to p on the triangle abc.
template <class F>
STANDOFF_HD Triple<F> closest_on_triangle(const Triple<F>& p, const Triple<F>& a, const Triple<F>& b,
                                          const Triple<F>& c) {
  const F zero(0);
  const Triple<F> ab = b - a, ac = c - a, ap = p - a;
  const F d1 = dot(ab, ap), d2 = dot(ac, ap);
  if (d1 <= zero && d2 <= zero) return a;

  const Triple<F> bp = p - b;
  const F d3 = dot(ab, bp), d4 = dot(ac, bp);
  if (d3 >= zero && d4 <= d3) return b;

  const Triple<F> cp = p - c;
  const F d5 = dot(ab, cp), d6 = dot(ac, cp);
  if (d6 >= zero && d5 <= d6) return c;

  // Twice the areas of the triangles that p's projection makes with each edge, all scaled by the normal's length.
  const Triple<F> n = cross(ab, ac);
  const F vc = dot(n, cross(ap, bp));
  if (vc <= zero && d1 >= zero && d3 <= zero) return closest_on_segment(p, a, b);
  const F vb = dot(n, cross(cp, ap));
  if (vb <= zero && d2 >= zero && d6 <= zero) return closest_on_segment(p, a, c);
  const F va = dot(n, cross(bp, cp));
  if (va <= zero && d4 >= d3 && d5 >= d6) return closest_on_segment(p, b, c);

  const F sum = va + vb + vc;
  if (!(va > zero && vb > zero && vc > zero) || !(sum > zero)) return closest_on_segment(p, a, b);
  return a + ab * (vb / sum) + ac * (vc / sum);
}

}  // namespace standoff
