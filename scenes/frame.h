// SPDX-License-Identifier: Apache-2.0
// Where a part stands: an affine map from its own coordinates to the scene's.
#pragma once

#include "scenes/circle.h"
#include "standoff/vec.h"

namespace standoff::scenes {

inline Vec3 normalized(Vec3 v) { return v * (1 / length(v)); }

/// Some unit vector at right angles to the unit vector v.
inline Vec3 perpendicular(Vec3 v) {
  const Vec3 a{std::abs(v.x), std::abs(v.y), std::abs(v.z)};
  const Vec3 axis = a.y <= a.x && a.y <= a.z ? Vec3{0, 1, 0} : (a.x <= a.z ? Vec3{1, 0, 0} : Vec3{0, 0, 1});
  return normalized(cross(v, axis));
}

/// Maps p to origin + p.x * x + p.y * y + p.z * z. Right-handed frames keep the orientation of triangles.
struct Frame {
  Vec3 origin;
  Vec3 x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};

  Vec3 direction(Vec3 v) const { return x * v.x + y * v.y + z * v.z; }
  Vec3 operator()(Vec3 p) const { return origin + direction(p); }

  /// This frame moved by `offset`, given in its own coordinates.
  Frame at(Vec3 offset) const { return {(*this)(offset), x, y, z}; }
  Frame at(double px, double py, double pz) const { return at(Vec3{px, py, pz}); }
  /// A frame inside this one.
  Frame operator*(const Frame& f) const { return {(*this)(f.origin), direction(f.x), direction(f.y), direction(f.z)}; }
  Frame scaled(double sx, double sy, double sz) const { return {origin, x * sx, y * sy, z * sz}; }
  Frame scaled(double s) const { return scaled(s, s, s); }
  /// Turned about an own axis, counterclockwise seen from its tip, by a part of a full turn.
  Frame about_x(double turns) const {
    const auto [c, s] = circle(turns);
    return {origin, x, y * c + z * s, z * c - y * s};
  }
  Frame about_y(double turns) const {
    const auto [c, s] = circle(turns);
    return {origin, x * c - z * s, y, z * c + x * s};
  }
  Frame about_z(double turns) const {
    const auto [c, s] = circle(turns);
    return {origin, x * c + y * s, y * c - x * s, z};
  }
  /// With the own y axis along the scene's +x, -x, ... : for parts that are described standing upright.
  Frame y_to_x() const { return {origin, y * -1, x, z}; }
  Frame y_to_z() const { return {origin, x, z, y * -1}; }
  Frame y_to_minus_y() const { return {origin, x, y * -1, z * -1}; }
};

/// The frame at `from` whose y axis points to `to`, of length one.
inline Frame along(Vec3 from, Vec3 to) {
  const Vec3 y = normalized(to - from);
  const Vec3 x = perpendicular(y);
  return {from, x, y, cross(x, y)};
}

}  // namespace standoff::scenes
