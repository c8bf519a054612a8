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

Turn turn_of(const std::array<double, 9>& r) {
  const Vec3 skew = Vec3{r[7] - r[5], r[2] - r[6], r[3] - r[1]} * 0.5;  // sin(angle) axis
  const double sine = length(skew), cosine = (r[0] + r[4] + r[8] - 1) / 2;
  Turn turn;
  turn.angle_rad = std::atan2(sine, cosine);
  if (cosine > 0 || sine > 1e-3) {
    if (sine > 0) turn.axis = skew * (1 / sine);
    return turn;
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
  turn.axis = axis;
  return turn;
}

Vec3 turned(Vec3 v, Vec3 axis, double angle_rad) {
  if (angle_rad == 0) return v;
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  return v * c + cross(axis, v) * s + axis * (dot(axis, v) * (1 - c));
}

Course::Course(const RigidMotion& m)
    : motion(m),
      turn(m.from.rotation == m.to.rotation ? Turn{} : turn_of(times_transposed(m.to.rotation, m.from.rotation))) {
  // Without a turn all points go straight, and a centre far away would only bring its rounding.
  if (m.from.rotation == m.to.rotation) motion.center = {};
  center = apply(m.from, motion.center);
  velocity = apply(m.to, motion.center) - center;
}

Pose Course::at(double t) const {
  if (t <= 0) return motion.from;
  if (t >= 1) return motion.to;
  Pose pose = motion.from;
  if (turn.angle_rad != 0) {
    const auto& r = motion.from.rotation;
    const double angle = turn.angle_rad * t;
    for (int column = 0; column < 3; ++column) {
      const Vec3 v = turned({r[column], r[3 + column], r[6 + column]}, turn.axis, angle);
      pose.rotation[column] = v.x, pose.rotation[3 + column] = v.y, pose.rotation[6 + column] = v.z;
    }
    pose.translation = center + velocity * t - rotate(pose, motion.center);
  } else {
    pose.translation = motion.from.translation + (motion.to.translation - motion.from.translation) * t;
  }
  return pose;
}

RelativeMotion::RelativeMotion(const Pair& pair, const Course& course) {
  // In the pair the field stands at its pose; where it moves that is its pose at time 0.
  const Pose &field = pair.frame, &tree = pair.tree.pose;
  const Vec3 middle = apply(pair.field.pose, pair.field.body->middle);
  way_.field_moves = pair.swapped;
  way_.angle_rad = pair.swapped ? -course.turn.angle_rad : course.turn.angle_rad;
  way_.axis = triple_of(rotate_back(field, course.turn.axis));
  const Vec3 velocity = rotate_back(field, course.velocity);
  way_.velocity = triple_of(velocity);
  way_.straight = standoff::length(velocity);
  way_.base = triple_of(rotate_back(field, course.center - middle));
  way_.start = place_of({transposed_times(field.rotation, tree.rotation),
                         rotate_back(field, apply(tree, pair.tree.body->middle) - course.center)});
}

}  // namespace collision

Pose pose_at(const RigidMotion& motion, double t) try {
  validate(motion.from);
  validate(motion.to);
  if (!(t >= 0 && t <= 1))
    throw Error(ErrorCode::usage, "motion: the time must be from 0 to 1; 0 is the start, 1 the end");
  return collision::Course(motion).at(t);
} catch (...) {
  throw_as_error("motion");
}

}  // namespace standoff
