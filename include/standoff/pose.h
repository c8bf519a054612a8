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

/// Applies only the rotation. The expression is evaluated as written: three products and two sums per coordinate, from
/// x to z.
constexpr Vec3 rotate(const Pose& pose, Vec3 p) {
  const auto& r = pose.rotation;
  return {r[0] * p.x + r[1] * p.y + r[2] * p.z, r[3] * p.x + r[4] * p.y + r[5] * p.z,
          r[6] * p.x + r[7] * p.y + r[8] * p.z};
}
/// Maps a point of the body to world coordinates.
constexpr Vec3 apply(const Pose& pose, Vec3 p) { return rotate(pose, p) + pose.translation; }

/// Applies the inverse rotation, which is the transpose.
constexpr Vec3 rotate_back(const Pose& pose, Vec3 v) {
  const auto& r = pose.rotation;
  return {r[0] * v.x + r[3] * v.y + r[6] * v.z, r[1] * v.x + r[4] * v.y + r[7] * v.z,
          r[2] * v.x + r[5] * v.y + r[8] * v.z};
}
/// Maps a point in world coordinates to the body's coordinates.
constexpr Vec3 apply_inverse(const Pose& pose, Vec3 p) { return rotate_back(pose, p - pose.translation); }

/// The pose that applies `inner`, then `outer`.
STANDOFF_API Pose compose(const Pose& outer, const Pose& inner);

/// A rotation by `angle_rad` about `axis` through the origin (right-handed; the axis may have any length but zero),
/// then a translation. Errors: usage (a zero axis, or a number that is not finite).
STANDOFF_API Pose make_pose(Vec3 axis, double angle_rad, Vec3 translation);

/// The largest allowed difference, per entry, between the identity and the product of a rotation and its transpose.
/// Rotations stored in single precision fulfil it.
inline constexpr double kRigidTolerance = 1e-6;

/// The largest magnitude of coordinates of poses, motions and bodies, world units: their squares are within single
/// precision's range.
inline constexpr double kMaxPosition = 1e15;

/// Throws Error{usage} unless all numbers are finite, no coordinate of the translation is beyond kMaxPosition, and the
/// matrix is a rotation within kRigidTolerance: no scaling, shear or reflection.
STANDOFF_API void validate(const Pose& pose);

}  // namespace standoff
