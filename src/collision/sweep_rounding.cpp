// SPDX-License-Identifier: Apache-2.0
#include "collision/sweep_rounding.h"

#include <algorithm>
#include <cmath>

#include "collision/tolerances.h"

namespace standoff::collision {
namespace {

// How far a point of the body may be at the last pose from where the even rotation ends.
double jump_at_end(const AxisAngleMotion& path, const ModelData& body) {
  const RigidMotion& m = path.poses;
  if (m.from.rotation == m.to.rotation) return 0;
  double off_sq = 0;
  for (int column = 0; column < 3; ++column) {
    const auto of = [column](const Pose& pose) {
      return Vec3{pose.rotation[column], pose.rotation[3 + column], pose.rotation[6 + column]};
    };
    const Vec3 off = of(m.to) - rotated(of(m.from), path.rotation.axis, path.rotation.angle_rad);
    off_sq += dot(off, off);
  }
  return std::sqrt(off_sq) * (length(body.middle - m.center) + body.radius);
}

}  // namespace

double pose_rounding(const QueryPair& pair, const AxisAngleMotion& path) {
  return kPoseRounding * (pair.far + length(path.center) + length(path.velocity));
}

// Half of the tolerance is kept between the bodies.
double tolerance_kept(const QueryPair& pair, const AxisAngleMotion& path, double asked) {
  return std::max(asked, 2 * pose_rounding(pair, path));
}

// The rounding of time moves a body on a very long motion: four such errors add up.
float distance_kept(const QueryPair& pair, const AxisAngleMotion& path, double tolerance) {
  const double turning = path.rotation.angle_rad * length(path.poses.center);
  const double rounding = 4 * kTimeRounding * (length(path.velocity) + length(path.center) + turning);
  return pair.limit(tolerance) + static_cast<float>(rounding);
}

// The bodies were half the tolerance apart all the time; a jump shorter than that touches nothing.
bool last_pose_may_jump(const AxisAngleMotion& path, const CollisionModel& moving, double tolerance) {
  return !(jump_at_end(path, data_of(moving)) < tolerance / 4);
}

}  // namespace standoff::collision
