// The closest points of two triangles that do not cross, without branches: for double, and for eight doubles at once.
//
// They lie on an edge of each, or on a corner of one and over the inside of the other: nine pairs of segments and six
// corners. Nothing is fused, so that all instruction sets round alike.
#pragma once

#include "geometry/triple.h"

namespace difi::collision {

template <class F>
struct PairPoints {
  F distance_sq;
  Triple<F> on_p, on_q;
};

/// Without fused operations, unlike those of the geometry room.
template <class F>
DIFI_INLINE F plain_dot(const Triple<F>& a, const Triple<F>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class F>
DIFI_INLINE Triple<F> plain_cross(const Triple<F>& a, const Triple<F>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// A triangle with what its edges need: edge k leads from corner k to the next one.
template <class F>
struct Edges {
  Triple<F> corner[3], way[3];
  F inverse_sq[3];  ///< of the length; 0 for none
  F length_sq[3];
};

template <class F>
DIFI_INLINE Edges<F> edges_of(const Triple<F> (&corner)[3]) {
  Edges<F> e;
  for (int k = 0; k < 3; ++k) {
    e.corner[k] = corner[k];
    e.way[k] = corner[(k + 1) % 3] - corner[k];
    e.length_sq[k] = plain_dot(e.way[k], e.way[k]);
    const auto some = less(F(0), e.length_sq[k]);
    e.inverse_sq[k] = select(some, F(1) / select(some, e.length_sq[k], F(1)), F(0));
  }
  return e;
}

template <class F>
DIFI_INLINE void take_if_nearer(PairPoints<F>& best, const Triple<F>& on_p, const Triple<F>& on_q) {
  const Triple<F> way = on_q - on_p;
  const F distance_sq = plain_dot(way, way);
  const auto nearer = less(distance_sq, best.distance_sq);
  best.distance_sq = select(nearer, distance_sq, best.distance_sq);
  best.on_p = select(nearer, on_p, best.on_p);
  best.on_q = select(nearer, on_q, best.on_q);
}

/// Edge i of p and edge j of q. The first guess at the place on p's edge is that of the lines, the place on q's edge is
/// the best for it, and the place on p's edge then the best for that: each step only comes nearer, and together they
/// find the least distance (Ericson, Real-Time Collision Detection, 5.1.9).
template <class F>
DIFI_INLINE void try_edges(const Edges<F>& p, int i, const Edges<F>& q, int j, PairPoints<F>& best) {
  const auto within = [](const F& t) __attribute__((always_inline)) { return min(max(t, F(0)), F(1)); };
  const Triple<F>&u = p.way[i], &v = q.way[j], r = p.corner[i] - q.corner[j];
  const F ur = plain_dot(u, r), vr = plain_dot(v, r), uv = plain_dot(u, v);
  const F denominator = p.length_sq[i] * q.length_sq[j] - uv * uv;
  const auto skew = less(F(0), denominator);
  const F guess = select(skew, within((uv * vr - ur * q.length_sq[j]) / select(skew, denominator, F(1))), F(0));
  const F t = within((uv * guess + vr) * q.inverse_sq[j]);
  const F s = within((uv * t - ur) * p.inverse_sq[i]);
  take_if_nearer(best, p.corner[i] + u * s, q.corner[j] + v * t);
}

/// The foot of the perpendicular from a point, where it lies inside the triangle: a mean of the corners with positive
/// weights, so that even for slivers it is a point of the triangle, and no distance to it too small.
template <class F>
struct Feet {
  Triple<F> corner[3], inward[3], way_1, way_2;

  DIFI_INLINE explicit Feet(const Edges<F>& e)
      : corner{e.corner[0], e.corner[1], e.corner[2]}, way_1(e.way[0]), way_2(e.corner[2] - e.corner[0]) {
    const Triple<F> normal = plain_cross(way_1, way_2);
    for (int k = 0; k < 3; ++k) inward[k] = plain_cross(normal, e.way[k]);
  }
  /// Sets `foot`, and tells where it lies inside.
  DIFI_INLINE auto below(const Triple<F>& point, Triple<F>& foot) const {
    const F a = plain_dot(inward[0], point - corner[0]), b = plain_dot(inward[1], point - corner[1]),
            c = plain_dot(inward[2], point - corner[2]);
    const auto inside = less(F(0), min(a, min(b, c)));
    const F inverse = F(1) / select(inside, a + b + c, F(1));
    foot = corner[0] + way_1 * (c * inverse) + way_2 * (a * inverse);
    return inside;
  }
};

/// Errors are those of the arithmetic of F. Of triangles that touch at an edge the result is where; of crossing ones it
/// is that of their edges and corners.
template <class F>
DIFI_INLINE PairPoints<F> closest_pair(const Triple<F> (&p)[3], const Triple<F> (&q)[3]) {
  const Edges<F> edges_p = edges_of(p), edges_q = edges_of(q);
  PairPoints<F> best{F(__builtin_inf()), p[0], q[0]};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) try_edges(edges_p, i, edges_q, j, best);
  const Feet<F> feet_p(edges_p), feet_q(edges_q);
  for (int k = 0; k < 3; ++k) {
    // Where the foot lies outside it gives way to the corner, which is no nearer than the edges.
    Triple<F> foot;
    const auto over_q = feet_q.below(p[k], foot);
    take_if_nearer(best, p[k], select(over_q, foot, q[0]));
    const auto over_p = feet_p.below(q[k], foot);
    take_if_nearer(best, select(over_p, foot, p[0]), q[k]);
  }
  return best;
}

}  // namespace difi::collision
