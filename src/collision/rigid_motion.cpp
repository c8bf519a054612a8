// SPDX-License-Identifier: Apache-2.0
#include "collision/rigid_motion.h"
#include "core/guarded.h"

#include <cmath>
#include <numbers>

namespace standoff {
namespace collision {
namespace {

// outer^T inner, as matrices.
std::array<double, 9> transposed_times(const std::array<double, 9>& outer, const std::array<double, 9>& inner) {
  std::array<double, 9> product{};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k) product[3 * i + j] += outer[3 * k + i] * inner[3 * k + j];
  return product;
}
// outer inner^T.
std::array<double, 9> times_transposed(const std::array<double, 9>& outer, const std::array<double, 9>& inner) {
  std::array<double, 9> product{};
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k < 3; ++k) product[3 * i + j] += outer[3 * i + k] * inner[3 * j + k];
  return product;
}

}  // namespace

AxisAngle axis_angle_of(const std::array<double, 9>& r) {
  const Vec3 skew = Vec3{r[7] - r[5], r[2] - r[6], r[3] - r[1]} * 0.5;  // sin(angle) axis
  const double sine = length(skew), cosine = (r[0] + r[4] + r[8] - 1) / 2;
  AxisAngle rotation;
  rotation.angle_rad = std::atan2(sine, cosine);
  if (cosine > 0 || sine > 1e-3) {
    if (sine > 0) rotation.axis = skew * (1 / sine);
    return rotation;
  }
  // Near half a turn the skew part is lost in rounding; (R + R^T) / 2 = cos + (1 - cos) axis axis^T is not.
  const double square[3] = {r[0] - cosine, r[4] - cosine, r[8] - cosine};
  int largest = 0;
  for (int n = 1; n < 3; ++n)
    if (square[n] > square[largest]) largest = n;
  double column[3];
  for (int n = 0; n < 3; ++n) column[n] = n == largest ? square[n] : (r[3 * n + largest] + r[3 * largest + n]) / 2;
  Vec3 axis{column[0], column[1], column[2]};
  axis = axis * (1 / length(axis));
  if (dot(axis, skew) < 0) axis = axis * -1.0;
  rotation.axis = axis;
  return rotation;
}

Vec3 rotated(Vec3 v, Vec3 axis, double angle_rad) {
  if (angle_rad == 0) return v;
  return vec_of(rotated(triple_of(v), triple_of(axis), std::cos(angle_rad), std::sin(angle_rad)));
}

AxisAngleMotion::AxisAngleMotion(const RigidMotion& m) : poses(m) {
  if (m.from.rotation == m.to.rotation)
    // Without a rotation all points move on straight lines, and a centre far away would only bring its rounding.
    poses.center = {};
  else
    rotation = axis_angle_of(times_transposed(m.to.rotation, m.from.rotation));
  center = apply(m.from, poses.center);
  velocity = apply(m.to, poses.center) - center;
}

Pose AxisAngleMotion::at(double t) const {
  const auto& [from, to, body_center] = poses;
  if (t <= 0) return from;
  if (t >= 1) return to;
  Pose pose = from;
  if (rotation.angle_rad != 0) {
    const auto& r = from.rotation;
    const double angle = rotation.angle_rad * t;
    for (int column = 0; column < 3; ++column) {
      const Vec3 v = rotated({r[column], r[3 + column], r[6 + column]}, rotation.axis, angle);
      pose.rotation[column] = v.x, pose.rotation[3 + column] = v.y, pose.rotation[6 + column] = v.z;
    }
    pose.translation = center + velocity * t - rotate(pose, body_center);
  } else {
    pose.translation = from.translation + (to.translation - from.translation) * t;
  }
  return pose;
}

RelativeMotion relative_motion(const QueryPair& pair, const AxisAngleMotion& path) {
  // In the pair the target stands at its pose; where it moves, at its pose at time 0.
  const Pose &target = pair.frame, &probe = pair.probe.pose;
  const Vec3 middle = apply(pair.target.pose, pair.target.body->middle);
  const Vec3 velocity = rotate_back(target, path.velocity);
  return {.target_moves = pair.swapped,
          .base = triple_of(rotate_back(target, path.center - middle)),
          .velocity = triple_of(velocity),
          .axis = triple_of(rotate_back(target, path.rotation.axis)),
          .angle_rad = pair.swapped ? -path.rotation.angle_rad : path.rotation.angle_rad,
          .speed_of_base = standoff::length(velocity),
          .start = transform_of({transposed_times(target.rotation, probe.rotation),
                                 rotate_back(target, apply(probe, pair.probe.body->middle) - path.center)})};
}

}  // namespace collision

Pose pose_at(const RigidMotion& motion, double t) try {
  validate(motion.from);
  validate(motion.to);
  if (!(t >= 0 && t <= 1))
    throw Error(ErrorCode::usage, "motion: the time must be from 0 to 1; 0 is the start, 1 the end");
  return collision::AxisAngleMotion(motion).at(t);
} catch (...) {
  throw_as_error("motion");
}

}  // namespace standoff
