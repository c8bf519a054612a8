// SPDX-License-Identifier: Apache-2.0
// The closest points of two triangles that do not cross, without branches: for double, and for eight doubles at once.
//
// They lie on an edge of each, or at a corner of one and over the inside of the other: nine pairs of segments and six
// corners. No operations are fused, so that all instruction sets give the same bits.
//
// The error of the distance is a few roundings of the pair's extent, for any shapes (docs/distance.md says how many, a
// test checks it): points on an edge and over a face come from vectors that are made perpendicular to one another, not
// from determinants, whose errors grow as nearly parallel edges and slivers get thinner. Along such an edge the
// position may be wrong, but only where this changes the distance by a rounding.
#pragma once

#include "geometry/triple.h"

namespace standoff {

template <class F>
struct PairPoints {
  F distance_sq;
  Triple<F> on_p, on_q;
  Triple<F> separation;  ///< from on_p to on_q; far from the origin, their difference would lose digits
};

/// A dot product without fused operations, unlike the rest of src/geometry.
template <class F>
STANDOFF_INLINE F plain_dot(const Triple<F>& a, const Triple<F>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class F>
STANDOFF_INLINE Triple<F> plain_cross(const Triple<F>& a, const Triple<F>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// A triangle and its edges: edge k leads from corner k to the next one.
template <class F>
struct Edges {
  Triple<F> corner[3], edge[3];
  F inverse_sq[3];  ///< 1 / length^2; 0 for an edge without length
};

template <class F>
STANDOFF_INLINE Edges<F> edges_of(const Triple<F> (&corner)[3]) {
  Edges<F> e;
  for (int k = 0; k < 3; ++k) {
    e.corner[k] = corner[k];
    e.edge[k] = corner[(k + 1) % 3] - corner[k];
    const F length_sq = plain_dot(e.edge[k], e.edge[k]);
    const auto some = less(F(0), length_sq);
    e.inverse_sq[k] = select(some, F(1) / select(some, length_sq, F(1)), F(0));
  }
  return e;
}

template <class F>
STANDOFF_INLINE void take_if_nearer(PairPoints<F>& best, const Triple<F>& on_p, const Triple<F>& on_q) {
  const Triple<F> separation = on_q - on_p;
  const F distance_sq = plain_dot(separation, separation);
  const auto nearer = less(distance_sq, best.distance_sq);
  best.distance_sq = select(nearer, distance_sq, best.distance_sq);
  best.on_p = select(nearer, on_p, best.on_p);
  best.on_q = select(nearer, on_q, best.on_q);
}

/// The closest points of edge i of p and edge j of q, in three steps. First the position on p's edge that is closest to
/// q's line: `across` and `start` are the components of p's edge and of the start's offset perpendicular to q's edge,
/// and the position minimises |start + position * across|. Then the best position on q's edge for this one, and the
/// best on p's edge for that one. Each step only decreases the distance, and together they find the least one (Ericson,
/// Real-Time Collision Detection, 5.1.9).
template <class F>
STANDOFF_INLINE void try_edges(const Edges<F>& p, int i, const Edges<F>& q, int j, PairPoints<F>& best) {
  const auto within = [](const F& t) __attribute__((always_inline)) { return min(max(t, F(0)), F(1)); };
  const Triple<F>&u = p.edge[i], &v = q.edge[j], r = p.corner[i] - q.corner[j];
  const F uv = plain_dot(u, v), u_on_v = uv * q.inverse_sq[j], r_on_v = plain_dot(v, r) * q.inverse_sq[j];
  const Triple<F> across = u - v * u_on_v, start = r - v * r_on_v;
  const F across_sq = plain_dot(across, across);
  const auto skew = less(F(0), across_sq);
  const F guess = select(skew, within(-plain_dot(across, start) / select(skew, across_sq, F(1))), F(0));
  const F t = within(u_on_v * guess + r_on_v);
  const F s = within((uv * t - plain_dot(u, r)) * p.inverse_sq[i]);
  take_if_nearer(best, p.corner[i] + u * s, q.corner[j] + v * t);
}

/// The foot of the perpendicular from a point, if it lies inside the triangle. It is a mean of the corners with
/// positive weights: so even for slivers it is a point of the triangle, and no distance to it is too small.
template <class F>
struct Feet {
  Triple<F> corner, along, side;  ///< the first corner, and the edges from it
  Triple<F> across;               ///< the component of `side` perpendicular to `along`
  F along_inverse_sq, across_inverse_sq, side_on_along;

  STANDOFF_INLINE explicit Feet(const Edges<F>& e)
      : corner(e.corner[0]), along(e.edge[0]), side(e.corner[2] - e.corner[0]), along_inverse_sq(e.inverse_sq[0]) {
    side_on_along = plain_dot(along, side) * along_inverse_sq;
    across = side - along * side_on_along;
    // Orthogonalise once more: rounding left a part along `along`, which is large for a sliver.
    across = across - along * (plain_dot(along, across) * along_inverse_sq);
    const F across_sq = plain_dot(across, across);
    const auto flat = less(F(0), across_sq);
    across_inverse_sq = select(flat, F(1) / select(flat, across_sq, F(1)), F(0));
  }
  /// Sets `foot`; returns the lanes where it lies inside.
  STANDOFF_INLINE auto below(const Triple<F>& point, Triple<F>& foot) const {
    const Triple<F> r = point - corner;
    const F y = plain_dot(across, r) * across_inverse_sq;
    const F x = plain_dot(along, r) * along_inverse_sq - y * side_on_along;
    foot = corner + along * x + side * y;
    return less(F(0), min(min(x, y), F(1) - x - y));
  }
};

/// The closest points of two triangles. If they touch at an edge, both are the point of contact; if they cross, they
/// are the closest points of edges and corners alone.
template <class F>
STANDOFF_INLINE PairPoints<F> closest_pair(const Triple<F> (&world_p)[3], const Triple<F> (&world_q)[3]) {
  // Take coordinates relative to a corner: far from the origin nothing is lost.
  const Triple<F> origin = world_p[0];
  const Triple<F> p[3] = {world_p[0] - origin, world_p[1] - origin, world_p[2] - origin},
                  q[3] = {world_q[0] - origin, world_q[1] - origin, world_q[2] - origin};
  const Edges<F> edges_p = edges_of(p), edges_q = edges_of(q);
  PairPoints<F> best{F(__builtin_inf()), p[0], q[0], {}};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) try_edges(edges_p, i, edges_q, j, best);
  const Feet<F> feet_p(edges_p), feet_q(edges_q);
  for (int k = 0; k < 3; ++k) {
    // If the foot lies outside, take a corner instead, which is no nearer than the edges.
    Triple<F> foot;
    const auto over_q = feet_q.below(p[k], foot);
    take_if_nearer(best, p[k], select(over_q, foot, q[0]));
    const auto over_p = feet_p.below(q[k], foot);
    take_if_nearer(best, select(over_p, foot, p[0]), q[k]);
  }
  best.separation = best.on_q - best.on_p;
  best.on_p = best.on_p + origin, best.on_q = best.on_q + origin;
  return best;
}

}  // namespace standoff
