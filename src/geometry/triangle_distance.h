// SPDX-License-Identifier: Apache-2.0
// The distance of a triangle from the origin, without branches: the measure by which exact queries at points compare
// triangles (docs/points.md). Corners are given relative to the query point, so a mesh far from the origin loses
// nothing. One source for scalars, wide types and the GPU, with the same roundings: so with the same bits.
//
// The nearest of four points is taken: of each edge, and of the face where the origin's projection lies inside. All are
// points of the triangle, up to rounding, so a distance is never too small; and the edges keep it right where rounding
// hides the width of a sliver.
//
// Triangles that share an edge or a corner compute the same bits for it, whatever their orders of corners: equally near
// triangles are then equally near in bits too, and the lowest index decides. So an edge is measured from its middle:
// half of its vector changes nothing but sign when its ends change places.
#pragma once

#include "geometry/triple.h"

namespace standoff {

/// The point of the segment from a to b nearest to the origin; b if the segment has no length.
template <class F>
STANDOFF_INLINE Triple<F> nearest_on_edge(const Triple<F>& a, const Triple<F>& b) {
  const Triple<F> middle = (a + b) * F(0.5), half = (b - a) * F(0.5);
  const F along = -dot(middle, half), most = dot(half, half);
  const Triple<F> between = middle + half * F(along / most);
  const auto before_b = less(along, most), after_a = less(F(-most), along);
  return select(before_b, select(after_a, between, a), b);
}

/// The nearest point of the triangle's plane, by its barycentric coordinates, where all three of them are positive.
template <class F>
struct NearestInside {
  F across[3];  ///< positive shares of the point, in the order of the corners, if `inside`
  F sum;        ///< of the three
  F least;      ///< the smallest of them: inside where it is positive
};
template <class F>
STANDOFF_INLINE NearestInside<F> nearest_inside(const Triple<F>& a, const Triple<F>& b, const Triple<F>& c) {
  const Triple<F> normal = cross(b - a, c - a);
  NearestInside<F> at;
  at.across[0] = dot(normal, cross(b, c));
  at.across[1] = dot(normal, cross(c, a));
  at.across[2] = dot(normal, cross(a, b));
  at.sum = at.across[0] + at.across[1] + at.across[2];
  at.least = min(at.across[0], min(at.across[1], at.across[2]));
  return at;
}
template <class F>
STANDOFF_INLINE Triple<F> point_inside(const NearestInside<F>& at, const Triple<F>& a, const Triple<F>& b,
                                       const Triple<F>& c) {
  return a + (b - a) * F(at.across[1] / at.sum) + (c - a) * F(at.across[2] / at.sum);
}

/// The squared distance of the triangle from the origin.
template <class F>
STANDOFF_INLINE F origin_distance_sq(const Triple<F>& a, const Triple<F>& b, const Triple<F>& c) {
  const Triple<F> ab = nearest_on_edge(a, b), bc = nearest_on_edge(b, c), ca = nearest_on_edge(c, a);
  const F edges = min(dot(ab, ab), min(dot(bc, bc), dot(ca, ca)));
  const NearestInside<F> at = nearest_inside(a, b, c);
  const Triple<F> face = point_inside(at, a, b, c);
  return select(less(F(0), at.least), min(dot(face, face), edges), edges);
}

}  // namespace standoff
