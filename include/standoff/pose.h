// SPDX-License-Identifier: Apache-2.0
// Position and orientation of a rigid body.
#pragma once

#include <array>

#include "standoff/export.h"
#include "standoff/vec.h"

namespace standoff {

/// A rotation, then a translation: a point p of the body is at `rotation * p + translation` in the world.
struct Pose {
  std::array<double, 9> rotation = {1, 0, 0, 0, 1, 0, 0, 0, 1};  ///< row by row
  Vec3 translation;

  friend constexpr bool operator==(const Pose&, const Pose&) = default;
};

/// The rotation alone. Rounded as written: three products, two sums, from x to z.
constexpr Vec3 rotate(const Pose& pose, Vec3 p) {
  const auto& r = pose.rotation;
  return {r[0] * p.x + r[1] * p.y + r[2] * p.z, r[3] * p.x + r[4] * p.y + r[5] * p.z,
          r[6] * p.x + r[7] * p.y + r[8] * p.z};
}
/// A point of the body, in the world.
constexpr Vec3 apply(const Pose& pose, Vec3 p) { return rotate(pose, p) + pose.translation; }

/// The inverse rotation; the transpose is the inverse of a rotation.
constexpr Vec3 rotate_back(const Pose& pose, Vec3 v) {
  const auto& r = pose.rotation;
  return {r[0] * v.x + r[3] * v.y + r[6] * v.z, r[1] * v.x + r[4] * v.y + r[7] * v.z,
          r[2] * v.x + r[5] * v.y + r[8] * v.z};
}
/// A point of the world, in the body's coordinates.
constexpr Vec3 apply_inverse(const Pose& pose, Vec3 p) { return rotate_back(pose, p - pose.translation); }

/// First `inner`, then `outer`.
STANDOFF_API Pose compose(const Pose& outer, const Pose& inner);

/// Turned by `angle_rad` about `axis` through the origin (right hand; any length but zero), then moved.
/// Errors: usage when the axis has no direction or a number is not finite.
STANDOFF_API Pose make_pose(Vec3 axis, double angle_rad, Vec3 translation);

/// How far the product of a rotation and its transpose may be from the identity, per entry: what a rotation
/// that was stored in single precision keeps.
inline constexpr double kRigidTolerance = 1e-6;

/// Throws Error{usage} unless all numbers are finite, the translation below 1e15, and the rotation is one: no scaling,
/// shear or mirror.
STANDOFF_API void validate(const Pose& pose);

}  // namespace standoff
