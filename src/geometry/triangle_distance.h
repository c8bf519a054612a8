// SPDX-License-Identifier: Apache-2.0
// The distance of a triangle from the origin, without branches: exact queries at points compare triangles by it
// (docs/points_methods.md). Corners are relative to the query point, so a mesh far from the origin loses nothing.
// Scalars, wide types and the GPU share this source and its roundings, and so get the same bits.
//
// The distance is the least of four: from each edge, and from the face if the origin's projection lies inside. All four
// points are points of the triangle, up to rounding, so a distance is never too small; and the edges keep it right if
// rounding hides the width of a sliver.
//
// Triangles that share an edge or a corner get the same bits for it, whatever their order of corners: so equally near
// triangles are equal in bits too, and the lowest index wins. This is why an edge is measured from its middle: swapping
// the ends only changes the sign of half of its vector.
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

/// The nearest point of the triangle's plane, by its barycentric coordinates.
template <class F>
struct NearestInside {
  F across[3];  ///< the coordinates times `sum`, in the order of the corners
  F sum;        ///< their sum
  F least;      ///< the least of them: the point is inside if it is positive
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
