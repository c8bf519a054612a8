// SPDX-License-Identifier: Apache-2.0
// Squared distance to a triangle as the thesis computes it: Ericson's Voronoi regions, cross products replaced by dot
// products.
//
// Source: C. Ericson, Real-Time Collision Detection (2005), section 5.1.5, as the 2008 thesis uses it. Let n = ab x ac.
// A point p projects into the triangle when n . (ab x ap), n . (ap x ac) and n . (bc x bp) are positive. Lagrange's
// identity
//   (a x b) . (c x d) = (a . c)(b . d) - (a . d)(b . c)
// turns the first two into (ab.ab)(ac.ap) - (ab.ac)(ab.ap) and (ac.ac)(ab.ap) - (ab.ac)(ac.ap): |n|^2 times the
// barycentric weights w and v of c and b. Both are linear in ap, so their gradients are computed once per triangle, in
// double:
//   v = to_b . ap,  to_b = (ab (ac.ac) - ac (ab.ac)) / |n|^2
//   w = to_c . ap,  to_c = (ac (ab.ab) - ab (ab.ac)) / |n|^2
//
// If v, w and 1 - v - w are positive, the distance is the distance from the plane, else the least of the distances from
// the three edges; clamping the parameter of an edge covers the regions of its end points. Ericson tests region by
// region and returns early. Here nothing branches, because several samples are taken at once, and no rounding can open
// a gap between two regions.
//
// Error: all numbers per sample have type F. If the triangle and p are inside a box of diameter r, the distance is
// within 2 r epsilon(F) (tests/thesis/thesis_distance_test.cpp measures it, needles included). Ericson's own closest
// point a + v ab + w ac, with v and w from products of four lengths, loses (length / altitude)^2 times as much on
// needles. Degenerate triangles are their edges; edges of length zero are their first point.
#pragma once

#include "field/lattice.h"
#include "geometry/triangle_box.h"
#include "geometry/triple.h"
#include "standoff/vec.h"

namespace standoff {

/// A point on an edge is start + along * t, t in [0, 1]; t = clamp(dot(along, p - start) * inverse_length_sq).
template <class F>
struct ThesisEdge {
  Triple<F> start, along;
  F inverse_length_sq;  // 0 for an edge without length
};

template <class F>
struct ThesisTriangle {
  Triple<F> to_b, to_c, normal;  // all zero for a triangle without area; the normal is a unit vector
  ThesisEdge<F> ab, ac, bc;
};

template <class F>
STANDOFF_INLINE Triple<F> thesis_rounded(const Vec3& v) {
  return {static_cast<F>(v.x), static_cast<F>(v.y), static_cast<F>(v.z)};
}

template <class F>
STANDOFF_INLINE ThesisEdge<F> thesis_edge(const Vec3& start, const Vec3& along) {
  const double length_sq = dot(along, along);
  const bool usable = length_sq > 1e-30;  // shorter edges are points, far below the resolution of F
  return {thesis_rounded<F>(start), thesis_rounded<F>(along), static_cast<F>(usable ? 1 / length_sq : 0)};
}

/// The triangle with corners p, q, r. Coordinates should be of the order of 1: in units of the grid's spacing, relative
/// to a sample near the triangle.
template <class F>
STANDOFF_INLINE ThesisTriangle<F> make_thesis_triangle(const Vec3& p, const Vec3& q, const Vec3& r) {
  // Let a be the corner with the smallest altitude: then 1 - v - w is rounded like v and w, in units of larger
  // altitudes.
  const double pq_sq = dot(q - p, q - p), qr_sq = dot(r - q, r - q), rp_sq = dot(p - r, p - r);
  const double longest_sq = max(max(pq_sq, qr_sq), rp_sq);
  const Vec3 a = qr_sq == longest_sq ? p : rp_sq == longest_sq ? q : r;
  const Vec3 b = qr_sq == longest_sq ? q : rp_sq == longest_sq ? r : p;
  const Vec3 c = qr_sq == longest_sq ? r : rp_sq == longest_sq ? p : q;
  const Vec3 ab = b - a, ac = c - a, bc = c - b, n = cross(ab, ac);
  const double ab_sq = dot(ab, ab), ac_sq = dot(ac, ac), ab_ac = dot(ab, ac), n_sq = dot(n, n);
  ThesisTriangle<F> t{};
  // An altitude below 2^-24 of the longest edge is lost in float: then the edges alone give the same distance.
  if (longest_sq > 1e-30 && n_sq > 0x1p-48 * longest_sq * longest_sq) {
    t.to_b = thesis_rounded<F>((ab * ac_sq - ac * ab_ac) * (1 / n_sq));
    t.to_c = thesis_rounded<F>((ac * ab_sq - ab * ab_ac) * (1 / n_sq));
    t.normal = thesis_rounded<F>(n * (1 / sqrt(n_sq)));
  }
  t.ab = thesis_edge<F>(a, ab);
  t.ac = thesis_edge<F>(a, ac);
  t.bc = thesis_edge<F>(b, bc);
  return t;
}

// A dot product that is not fused, unlike that in triple.h: this header is compiled for any processor, and if fma is a
// call of the C library, the loop around it is not vectorised. x comes last, because the rest stays the same along a
// row of samples.
template <class F>
STANDOFF_INLINE F thesis_dot(const Triple<F>& a, const Triple<F>& b) {
  return (a.z * b.z + a.y * b.y) + a.x * b.x;
}

template <class F>
STANDOFF_INLINE F distance_sq(const ThesisEdge<F>& edge, const Triple<F>& p) {
  const Triple<F> from_start = p - edge.start;
  const F t = min(max(thesis_dot(edge.along, from_start) * edge.inverse_length_sq, F(0)), F(1));
  const Triple<F> difference = from_start - edge.along * t;
  return thesis_dot(difference, difference);
}

/// The squared distance from p to the triangle.
template <class F>
STANDOFF_INLINE F distance_sq(const ThesisTriangle<F>& t, const Triple<F>& p) {
  const Triple<F> ap = p - t.ab.start;
  const F v = thesis_dot(t.to_b, ap), w = thesis_dot(t.to_c, ap), above = thesis_dot(t.normal, ap);
  const F least_weight = min(min(v, w), F(1) - v - w);
  const F edges = min(distance_sq(t.ab, p), min(distance_sq(t.ac, p), distance_sq(t.bc, p)));
  return select(less(F(0), least_weight), above * above, edges);
}

// The part of Algorithm 1 that the CPU and the GPU share: the samples that a triangle visits, brick by brick, and the
// triangle in the coordinates of a brick.

/// The samples in a triangle's box grown by the thickness. Corners in world units.
STANDOFF_HD inline SampleRange visited_samples(const Triple<double> (&corner)[3], const Grid& grid, double thickness) {
  const BoxOf<double> box = box_of(corner[0], corner[1], corner[2]);
  return samples_in(Box{{box.low.x, box.low.y, box.low.z}, {box.high.x, box.high.y, box.high.z}}.grown(thickness),
                    grid);
}

/// The bricks, begin <= b < end, that hold samples of a range. Requires at least one sample.
STANDOFF_HD inline SampleRange bricks_of(const SampleRange& range) {
  constexpr std::int64_t side = kBrickSide;
  return {{range.begin.x / side, range.begin.y / side, range.begin.z / side},
          {(range.end.x - 1) / side + 1, (range.end.y - 1) / side + 1, (range.end.z - 1) / side + 1}};
}

/// The samples of a brick, including samples past the grid.
STANDOFF_HD inline SampleRange samples_of_brick(const Size3& brick) {
  constexpr std::int64_t side = kBrickSide;
  const Size3 first{brick.x * side, brick.y * side, brick.z * side};
  return {first, {first.x + side, first.y + side, first.z + side}};
}

/// The triangle relative to the centre of a brick, grid units. Corners in world units.
template <class F>
STANDOFF_INLINE ThesisTriangle<F> thesis_triangle(const Lattice& l, const Triple<double> (&corner)[3],
                                                  const Triple<double>& center) {
  return make_thesis_triangle<F>(vec_of(local(l, corner[0], center)), vec_of(local(l, corner[1], center)),
                                 vec_of(local(l, corner[2], center)));
}

}  // namespace standoff
