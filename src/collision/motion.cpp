// SPDX-License-Identifier: Apache-2.0
// Rigid motions: poses along them, the same motion in the frame of a pair's target, what rounding does to them, and
// which ones are valid.
#include <cmath>

#include "collision/sweep.h"
#include "core/guarded.h"
#include "core/number_text.h"

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

AxisAngle shorter_rotation(const std::array<double, 9>& r) {
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

}  // namespace

AxisAngle axis_angle_of(Vec3 axis, double angle_rad) {
  // Scale by a power of two, so that squares of the smallest and largest numbers are within range.
  const int exponent = -std::ilogb(max_norm(axis));
  axis = {std::scalbn(axis.x, exponent), std::scalbn(axis.y, exponent), std::scalbn(axis.z, exponent)};
  return {axis * (std::copysign(1.0, angle_rad) / length(axis)), std::abs(angle_rad)};
}

namespace {

// A column of a matrix.
Vec3 column_of(const std::array<double, 9>& matrix, std::size_t column) {
  return {matrix[column], matrix[3 + column], matrix[6 + column]};
}

// v turned about a unit axis.
Vec3 rotated(Vec3 v, Vec3 axis, double angle_rad) {
  if (angle_rad == 0) return v;
  return vec_of(collision::rotated(triple_of(v), triple_of(axis), std::cos(angle_rad), std::sin(angle_rad)));
}

}  // namespace

std::array<double, 9> turned(const std::array<double, 9>& matrix, Vec3 axis, double angle_rad) {
  std::array<double, 9> product{};
  for (std::size_t column = 0; column < 3; ++column) {
    const Vec3 v = rotated(column_of(matrix, column), axis, angle_rad);
    product[column] = v.x, product[3 + column] = v.y, product[6 + column] = v.z;
  }
  return product;
}

namespace {

// Whether the motion gives its axis and angle; otherwise its poses do.
bool has_axis(const RigidMotion& motion) { return motion.axis != Vec3{}; }

// A bound of the distance of the body's points from the axis.
double arm_of(const RigidMotion& motion, const BodyData& body) {
  return length(body.middle - motion.center) + body.radius;
}

}  // namespace

AxisAngleMotion::AxisAngleMotion(const RigidMotion& m) : poses(m) {
  if (has_axis(m))
    rotation = axis_angle_of(m.axis, m.angle_rad);
  else if (m.start.rotation != m.end.rotation)
    rotation = shorter_rotation(times_transposed(m.end.rotation, m.start.rotation));
  // Without a rotation all points move on straight lines, as at() has them: a centre far away would bring its rounding,
  // and, where the last pose is turned a little, another line.
  if (rotation.angle_rad == 0) poses.center = {};
  center = apply(m.start, poses.center);
  velocity = apply(m.end, poses.center) - center;
}

Pose AxisAngleMotion::at(double t) const {
  const Pose &from = poses.start, &to = poses.end;
  if (t <= 0) return from;
  if (t >= 1) return to;
  Pose pose = from;
  if (rotation.angle_rad != 0) {
    pose.rotation = turned(from.rotation, rotation.axis, rotation.angle_rad * t);
    pose.translation = center + velocity * t - rotate(pose, poses.center);
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

namespace {

// The rounding of the angle moves a body that turns far: its angles at two times and the time between are rounded.
// Where the rotation is the shorter one, kPoseRounding of the coordinates covers it.
double turning_rounding(const QueryPair& pair, const AxisAngleMotion& path) {
  if (!has_axis(path.poses)) return 0;
  const BodyData& moving = *(pair.swapped ? pair.target : pair.probe).body;
  return kTimeRounding * path.rotation.angle_rad * arm_of(path.poses, moving);
}

// The rounding of time moves a body on a very long motion: four such errors add up.
double time_rounding(const QueryPair& pair, const AxisAngleMotion& path) {
  const double turning = path.rotation.angle_rad * length(path.poses.center);
  return 4 * kTimeRounding * (length(path.velocity) + length(path.center) + turning) + 4 * turning_rounding(pair, path);
}

}  // namespace

double pose_rounding(const QueryPair& pair, const AxisAngleMotion& path) {
  return kPoseRounding * (pair.far + length(path.center) + length(path.velocity)) + turning_rounding(pair, path);
}

float distance_kept(const QueryPair& pair, const AxisAngleMotion& path, double tolerance) {
  return pair.limit(tolerance) + static_cast<float>(time_rounding(pair, path));
}

double reserve_of_nodes(const QueryPair& pair, const AxisAngleMotion& path, double tolerance) {
  const double on_the_way = kDoublePrecisionSlack * (length(path.velocity) + length(path.center));
  return kNodeReserve * tolerance + pair.pose_slack + on_the_way + time_rounding(pair, path);
}

double jump_at_end(const AxisAngleMotion& path, const BodyData& body) {
  const RigidMotion& m = path.poses;
  if (!has_axis(m) && m.start.rotation == m.end.rotation) return 0;
  double off_sq = 0;
  for (std::size_t column = 0; column < 3; ++column) {
    const Vec3 off = column_of(m.end.rotation, column) -
                     rotated(column_of(m.start.rotation, column), path.rotation.axis, path.rotation.angle_rad);
    off_sq += dot(off, off);
  }
  return std::sqrt(off_sq) * arm_of(m, body);
}

bool last_pose_may_jump(const AxisAngleMotion& path, const Body& moving, double tolerance) {
  return !(jump_at_end(path, data_of(moving)) < tolerance / 4);
}

// The checks of a motion by itself; `what` begins the messages.
void validate(const char* what, const RigidMotion& motion) {
  const auto fail = [what](const std::string& message) {
    throw Error(ErrorCode::usage, std::string(what) + ": " + message);
  };
  validate(motion.start);
  validate(motion.end);
  if (!is_finite(motion.center) || max_norm(motion.center) > kMaxPosition)
    fail("the motion's center is not finite or past " + number_text(kMaxPosition) + "; give a point of the body");
  if (!is_finite(motion.axis) || !(std::abs(motion.angle_rad) <= kMaxTurnRad))
    fail("the motion's axis is not finite, or its angle is not from -" + number_text(kMaxTurnRad) + " to " +
         number_text(kMaxTurnRad) + " radians; split the motion");
  if (!has_axis(motion)) {
    if (motion.angle_rad != 0) fail("the motion has an angle but no axis; give the axis too, or screw_motion()");
    return;
  }
  const AxisAngle turn = axis_angle_of(motion.axis, motion.angle_rad);
  const auto expected = turned(motion.start.rotation, turn.axis, turn.angle_rad);
  for (std::size_t n = 0; n < 9; ++n)
    if (!(std::abs(expected[n] - motion.end.rotation[n]) <= kTurnTolerance))
      fail("the motion's end is not its start turned by the angle about the axis: their matrices differ by more than " +
           number_text(kTurnTolerance) + "; let screw_motion() compute the end, or leave axis and angle out");
}

void validate_time(double t) {
  if (!(t >= 0 && t <= 1))
    throw Error(ErrorCode::usage, "motion: the time must be from 0 to 1; 0 is the start, 1 the end");
}

// Times are rounded. Where that alone moves a body by a good part of its size, no path is left to follow.
void check_length(const Body& a, const Body& b, const RigidMotion& motion, double tolerance) {
  check_length(a, b, length(apply(motion.end, motion.center) - apply(motion.start, motion.center)), motion, tolerance);
}

void check_length(const Body& a, const Body& b, double way, const RigidMotion& turn, double tolerance) {
  if (has_axis(turn)) way += std::abs(turn.angle_rad) * arm_of(turn, data_of(b));
  if (kTimeRounding * way <= std::max(tolerance, (data_of(a).radius + data_of(b).radius) / 8)) return;
  throw Error(ErrorCode::usage,
              "sweep: the motion is so long that rounding alone moves bodies of this size by a good part of it; "
              "sweep it in pieces");
}

}  // namespace collision

Pose pose_at(const RigidMotion& motion, double t) try {
  collision::validate("motion", motion);
  collision::validate_time(t);
  return collision::AxisAngleMotion(motion).at(t);
} catch (...) {
  throw_as_error("motion");
}

RigidMotion screw_motion(const Pose& start, Vec3 point, Vec3 axis, double angle_rad, double along) try {
  validate(start);
  if (!(max_norm(axis) > 0) || !is_finite(axis) || !is_finite(point) || !std::isfinite(along))
    throw Error(ErrorCode::usage,
                "motion: the axis needs a direction, and all numbers must be finite; give an axis of any length but "
                "zero and a point that it goes through");
  if (!(std::abs(angle_rad) <= kMaxTurnRad))
    throw Error(ErrorCode::usage, "motion: the angle must be from -" + number_text(kMaxTurnRad) + " to " +
                                      number_text(kMaxTurnRad) + " radians; split the motion");
  RigidMotion motion{start, start, apply_inverse(start, point), axis, angle_rad};
  const collision::AxisAngle turn = collision::axis_angle_of(axis, angle_rad);
  motion.end.rotation = collision::turned(start.rotation, turn.axis, turn.angle_rad);
  const Vec3 way = turn.axis * (std::signbit(angle_rad) ? -along : along);  // along the axis that was given
  motion.end.translation = apply(start, motion.center) + way - rotate(motion.end, motion.center);
  collision::validate("motion", motion);
  return motion;
} catch (...) {
  throw_as_error("motion");
}

}  // namespace standoff
