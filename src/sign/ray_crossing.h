// SPDX-License-Identifier: Apache-2.0
// Where a row of samples, a ray along +x, crosses a triangle. All decisions are signs of determinants, which are exact
// (geometry/predicates.h), so neighbouring triangles agree on the edge between them.
//
// Rays through an edge, a corner, or along a triangle are no special cases: every sample (x, y, z) stands for the point
// (x + e^3, y + e, z + e^2), where e is positive and smaller than any number ("simulation of simplicity", Edelsbrunner
// and Muecke 1990). That point is on no triangle with an area.
#pragma once

#include <array>

#include "geometry/predicates.h"
#include "standoff/vec.h"

namespace standoff {

using TriangleCorners = std::array<Vec3, 3>;

namespace ray {

inline int sign_of(double value) { return (value > 0) - (value < 0); }

/// On which side of the line from a to b the point (y, z) is, seen along x from +x: 1 left, -1 right. 0 only where a
/// and b have the same y and z.
inline int side_of_edge(const Vec3& a, const Vec3& b, double y, double z) {
  if (const int side = orient2d({a.y, a.z}, {b.y, b.z}, {y, z})) return side;
  if (a.z != b.z) return sign_of(a.z - b.z);
  return sign_of(b.y - a.y);
}

/// 1 where the row through (y, z) leaves the solid at this triangle, which is where the normal has a positive x; -1
/// where it enters it; 0 where it misses the triangle.
inline int crossing(const TriangleCorners& t, double y, double z) {
  const int side = side_of_edge(t[0], t[1], y, z);
  if (side == 0 || side_of_edge(t[1], t[2], y, z) != side || side_of_edge(t[2], t[0], y, z) != side) return 0;
  return side;
}

/// Whether a sample of a row is past the triangle's plane, seen from -x. `crossing` is that of the row, not 0.
inline bool is_past(const TriangleCorners& t, const Vec3& sample, int crossing) {
  int side = orient3d(t[0], t[1], t[2], sample);
  if (side == 0) side = orient2d({t[0].z, t[0].x}, {t[1].z, t[1].x}, {t[2].z, t[2].x});  // of the normal's y
  if (side == 0) side = orient2d({t[0].x, t[0].y}, {t[1].x, t[1].y}, {t[2].x, t[2].y});  // of its z
  if (side == 0) side = crossing;                                                        // of its x
  return side * crossing > 0;
}

}  // namespace ray
}  // namespace standoff
