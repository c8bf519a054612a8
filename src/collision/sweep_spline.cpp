// SPDX-License-Identifier: Apache-2.0
// Sweeps along cubic curves (docs/collision_methods.md). A piece of a curve is near its chord: with times as they are,
// the two are apart by at most max |c''| h^2 / 8 over a piece of duration h. So a body on the chord is the body on the
// curve, moved by no more than that, and a sweep along the chord that keeps a larger distance certifies the curve.
#include <algorithm>
#include <array>
#include <cmath>

#include "collision/sweep.h"
#include "core/guarded.h"
#include "core/number_text.h"

namespace standoff {
namespace collision {
namespace {

// A piece is at most this part of the distance of the bodies away from its chord.
constexpr double kChordShare = 1.0 / 32;
// A chord is swept with a tolerance of this many times its distance from the curve. A sweep keeps half of its tolerance
// between the bodies, which is four times the distance.
constexpr double kTolerancePerDeviation = 8;
// Poses on the curve are rounded more often than those on a straight motion: a tolerance below this many times
// kPoseRounding of the coordinates counts as that.
constexpr double kRoundingsPerTolerance = 16;

class Spline {
 public:
  explicit Spline(const SplineMotion& motion)
      : motion_(motion),
        point_{apply(motion.start, motion.center), motion.control[0], motion.control[1], motion.control[2]} {
    if (motion.angle_rad != 0) turn_ = axis_angle_of(motion.axis, motion.angle_rad);
  }

  Pose at(double t) const {
    if (t <= 0) return motion_.start;
    Pose pose = motion_.start;
    if (turn_.angle_rad != 0) pose.rotation = turned(motion_.start.rotation, turn_.axis, turn_.angle_rad * t);
    pose.translation = center_at(t) - rotate(pose, motion_.center);
    return pose;
  }

  RigidMotion chord(double t, double until) const {
    RigidMotion motion{at(t), at(until), motion_.center};
    if (turn_.angle_rad != 0) motion.axis = turn_.axis, motion.angle_rad = turn_.angle_rad * (until - t);
    return motion;
  }

  /// An upper bound of the distance of the curve from its chord. The second derivative is linear in t, so it is largest
  /// at one of the ends.
  double deviation(double t, double until) const {
    const double h = until - t;
    return std::max(length(acceleration_at(t)), length(acceleration_at(until))) * h * h / 8;
  }

  /// The curve is no longer than its control polygon.
  double way() const {
    return length(point_[1] - point_[0]) + length(point_[2] - point_[1]) + length(point_[3] - point_[2]);
  }
  /// A bound of the coordinates: the curve is in the hull of its control points.
  double far() const {
    double far = 0;
    for (const Vec3& point : point_) far = std::max(far, length(point));
    return far;
  }

 private:
  // De Casteljau's algorithm.
  Vec3 center_at(double t) const {
    std::array<Vec3, 4> p = point_;
    for (std::size_t count = 3; count > 0; --count)
      for (std::size_t n = 0; n < count; ++n) p[n] = p[n] * (1 - t) + p[n + 1] * t;
    return p[0];
  }
  Vec3 acceleration_at(double t) const {
    const Vec3 first = point_[2] - 2 * point_[1] + point_[0], last = point_[3] - 2 * point_[2] + point_[1];
    return 6 * (first * (1 - t) + last * t);
  }

  const SplineMotion& motion_;
  std::array<Vec3, 4> point_;
  AxisAngle turn_;
};

void validate_spline(const char* what, const SplineMotion& motion) {
  RigidMotion turn{motion.start, motion.start, motion.center, motion.axis, motion.angle_rad};
  if (motion.axis != Vec3{} && is_finite(motion.axis) && std::abs(motion.angle_rad) <= kMaxTurnRad) {
    const AxisAngle rotation = axis_angle_of(motion.axis, motion.angle_rad);
    turn.end.rotation = turned(motion.start.rotation, rotation.axis, rotation.angle_rad);
  }
  validate(what, turn);
  for (const Vec3& point : motion.control)
    if (!is_finite(point) || max_norm(point) > kMaxPosition)
      throw Error(ErrorCode::usage, std::string(what) + ": a control point of the curve is not finite or past " +
                                        number_text(kMaxPosition) + "; give points near the bodies");
}

}  // namespace

SweepResult hit_at(double t, const DistanceResult& nearest) {
  const Vec3 between = nearest.point_b - nearest.point_a;
  const double apart = length(between);
  return {true,
          t,
          nearest.triangle_a,
          nearest.triangle_b,
          nearest.point_a + between * 0.5,
          apart > 0 ? between * (1 / apart) : Vec3{}};
}

namespace {

// The bodies do not touch until `t`, which the sweeps of the pieces before have shown. Then their distance says how far
// the next piece may be from its chord. Where the sweep of a piece stops, the next one begins: there the bodies are
// nearer, and it is shorter. A distance within the tolerance is a hit.
SweepResult sweep_pieces(const Body& a, const Pose& pose_a, const Body& b, const Spline& spline, double tolerance,
                         Steps& steps) {
  double t = 0, duration = 1;
  for (;;) {
    const DistanceResult nearest = distance(a, pose_a, b, spline.at(t));
    if (!(nearest.upper > tolerance)) return hit_at(t, nearest);
    if (t >= 1) return {};
    double until = std::min(1.0, t + 2 * duration);
    while (spline.deviation(t, until) > kChordShare * nearest.upper) until = t + (until - t) / 2;
    if (!(until > t)) return hit_at(t, nearest);
    duration = until - t;
    const double kept = std::max(tolerance / 2, kTolerancePerDeviation * spline.deviation(t, until));
    const SweepResult piece = sweep_exactly(a, pose_a, b, spline.chord(t, until), kept, steps, best_kernels());
    const double reached = piece.hit || !piece.finished ? t + duration * piece.time : until;
    if (!piece.finished) {
      SweepResult unfinished;
      unfinished.time = reached;
      unfinished.finished = false;
      return unfinished;
    }
    if (!(reached > t)) return hit_at(t, nearest);
    t = reached;
  }
}

}  // namespace
}  // namespace collision

Pose spline_pose_at(const SplineMotion& motion, double t) try {
  collision::validate_spline("motion", motion);
  collision::validate_time(t);
  return collision::Spline(motion).at(t);
} catch (...) {
  throw_as_error("motion");
}

SweepResult sweep_spline(const Body& a, const Pose& pose_a, const Body& b, const SplineMotion& motion,
                         const SweepOptions& options) try {
  using namespace collision;
  const double asked = checked_tolerance(a, b, options);
  validate_spline("sweep_spline", motion);
  validate(pose_a);
  const Spline spline(motion);
  check_length(a, b, spline.way(), spline.chord(0, 1), asked);
  const BodyData& moving = data_of(b);
  const double far = spline.far() + length(pose_a.translation) + length(data_of(a).middle) + data_of(a).radius +
                     length(moving.middle) + length(motion.center) + moving.radius;
  const double arm = length(moving.middle - motion.center) + moving.radius;
  const double rounding = kPoseRounding * far + kTimeRounding * std::abs(motion.angle_rad) * arm;
  Steps steps(options.max_steps);
  return sweep_pieces(a, pose_a, b, spline, std::max(asked, kRoundingsPerTolerance * rounding), steps);
} catch (...) {
  throw_as_error("sweep_spline");
}

}  // namespace standoff
