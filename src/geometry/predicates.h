// SPDX-License-Identifier: Apache-2.0
// Exact signs, and accurate values, of determinants. A computation in double with an error bound decides nearly always,
// expansions decide the rest. All functions require coordinates that are zero or of magnitude 1e-90 to 1e100.
#pragma once

#include <array>

#include "geometry/determinant.h"
#include "standoff/vec.h"

namespace standoff {

/// The sign of det(b - a, c - a, d - a): 1 if d lies on the side of abc that (b - a) x (c - a) points to, 0 if and only
/// if the four points lie in a plane.
int orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);
/// The determinant: its sign is exact, and its relative error at most 4e-15.
double determinant3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);
/// The sign if the first stage cannot decide it.
int orient3d_beyond_rounding(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// The sign of det(b - a, c - a): 1 if a, b, c turn left; 0 if and only if they lie on a line.
int orient2d(const Flat& a, const Flat& b, const Flat& c);
/// The sign if the first stage cannot decide it.
int orient2d_beyond_rounding(const Flat& a, const Flat& b, const Flat& c);
/// The determinant: its sign is exact, and its relative error at most 4e-15.
double determinant2d(const Flat& a, const Flat& b, const Flat& c);

inline int orient2d(const Flat& a, const Flat& b, const Flat& c) {
  const RoundedDeterminant det = rounded_determinant2d(a, b, c);
  const double bound = kRounded2d * det.magnitude + kUnderflowOf2d;
  if (det.value > bound) return 1;
  if (-det.value > bound) return -1;
  return orient2d_beyond_rounding(a, b, c);
}

inline int orient3d(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const RoundedDeterminant det = rounded_determinant3d(a, b, c, d);
  // If products may have underflowed, the exact stage decides, which loses nothing of coordinates above 1e-90.
  const double bound = kRounded3d * det.magnitude + kUnderflowOf3d;
  if (det.value > bound) return 1;
  if (-det.value > bound) return -1;
  return orient3d_beyond_rounding(a, b, c, d);
}

using Corners = std::array<Vec3, 3>;

// Points, segments and triangles in one plane or on one line are decided exactly after dropping an axis that is not
// parallel to the plane.

/// The point without one coordinate; left turns stay left turns.
inline Flat dropped(const Vec3& v, int axis) {
  if (axis == 0) return {v.y, v.z};
  if (axis == 1) return {v.z, v.x};
  return {v.x, v.y};
}
using FlatCorners = std::array<Flat, 3>;
inline FlatCorners dropped(const Corners& t, int axis) {
  return {dropped(t[0], axis), dropped(t[1], axis), dropped(t[2], axis)};
}

/// A vector in the direction of a triangle's normal; zero if there is none. Its components are determinants, which are
/// accurate however thin the triangle is.
inline Vec3 normal_direction(const Corners& t) {
  const auto component = [&t](int axis) {
    return determinant2d(dropped(t[0], axis), dropped(t[1], axis), dropped(t[2], axis));
  };
  return {component(0), component(1), component(2)};
}

/// An axis along which the points' plane projects one-to-one; -1 if they lie on a line.
int upright_axis(const Vec3& a, const Vec3& b, const Vec3& c);
/// The same for four points of one plane.
int upright_axis(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// Whether segments pq and ab have a point in common.
bool segments_intersect(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b);

/// Whether segment pq, which lies in the triangle's plane, intersects the triangle. The triangle may be three points on
/// a line: then any segment on that line lies in its plane.
bool intersects_in_plane(const Vec3& p, const Vec3& q, const Corners& t);

/// A corner that both triangles have, or null. Neighbours in one mesh, and bodies with the same pose, have one.
inline const Vec3* common_corner(const Corners& p, const Corners& q) {
  for (const Vec3& corner : p)
    if (corner == q[0] || corner == q[1] || corner == q[2]) return &corner;
  return nullptr;
}

}  // namespace standoff
