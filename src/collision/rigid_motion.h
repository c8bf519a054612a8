// SPDX-License-Identifier: Apache-2.0
// Rigid motions in the world, and as the target of a pair sees the probe move.
#pragma once

#include "collision/query_pair.h"
#include "collision/relative_motion.h"

namespace standoff::collision {

/// A rotation about `axis` (unit length) by `angle_rad`, 0 to pi.
struct AxisAngle {
  Vec3 axis{0, 0, 1};
  double angle_rad = 0;
};
AxisAngle axis_angle_of(const std::array<double, 9>& rotation);

/// v turned about a unit axis.
Vec3 rotated(Vec3 v, Vec3 axis, double angle_rad);

/// A RigidMotion with its axis and angle.
struct AxisAngleMotion {
  RigidMotion poses;
  AxisAngle rotation;     ///< from `from` to `to`, in the world
  Vec3 center, velocity;  ///< in the world: the point that the body turns about at time 0, and its velocity

  explicit AxisAngleMotion(const RigidMotion& motion);
  Pose at(double t) const;
};

/// The motion of the pair's probe in the frame of its target.
RelativeMotion relative_motion(const QueryPair& pair, const AxisAngleMotion& path);

}  // namespace standoff::collision
