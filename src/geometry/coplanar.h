// SPDX-License-Identifier: Apache-2.0
// Points, segments and triangles that lie in one plane or on one line, exactly: after dropping an axis on which the
// plane does not stand upright.
#pragma once

#include <array>

#include "geometry/corners.h"
#include "geometry/predicates.h"

namespace standoff {

/// The point without one coordinate; what turns left still does.
inline Flat dropped(const Vec3& v, int axis) {
  if (axis == 0) return {v.y, v.z};
  if (axis == 1) return {v.z, v.x};
  return {v.x, v.y};
}
using FlatCorners = std::array<Flat, 3>;
inline FlatCorners dropped(const Corners& t, int axis) {
  return {dropped(t[0], axis), dropped(t[1], axis), dropped(t[2], axis)};
}

/// The direction of a triangle's normal, of any length, zero for none. Its components are determinants, right however
/// thin the triangle is.
inline Vec3 normal_direction(const Corners& t) {
  const auto component = [&t](int axis) {
    return determinant2d(dropped(t[0], axis), dropped(t[1], axis), dropped(t[2], axis));
  };
  return {component(0), component(1), component(2)};
}

/// An axis along which the points may be dropped into a plane without two of them falling together; -1: they lie on a
/// line.
int upright_axis(const Vec3& a, const Vec3& b, const Vec3& c);
/// The same for four points of one plane.
int upright_axis(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);

/// Whether segments pq and ab have a point in common.
bool segments_intersect(const Vec3& p, const Vec3& q, const Vec3& a, const Vec3& b);

/// Whether segment pq, which lies in the triangle's plane, intersects it. So does any segment in the plane of three
/// points on a line.
bool intersects_in_plane(const Vec3& p, const Vec3& q, const Corners& t);

/// A corner that both have; neighbours in one mesh, and bodies with the same pose, have one. Null: none.
inline const Vec3* common_corner(const Corners& p, const Corners& q) {
  for (const Vec3& corner : p)
    if (corner == q[0] || corner == q[1] || corner == q[2]) return &corner;
  return nullptr;
}

}  // namespace standoff
