// How points of one body move as the other one sees it: numbers alone, for the CPU and for GPUs.
#pragma once

#include "geometry/triangle_overlap.h"

namespace standoff::collision {

/// v turned about a unit axis.
STANDOFF_INLINE Triple<double> turned(const Triple<double>& v, const Triple<double>& axis, double cosine, double sine) {
  return v * cosine + plain_cross(axis, v) * sine + axis * (plain_dot(axis, v) * (1 - cosine));
}
STANDOFF_INLINE double length(const Triple<double>& v) { return sqrt(plain_dot(v, v)); }

/// The motion of points of the tree's body in the frame of the field's (relative to the middles). Points are told by
/// their offset from a base point at time 0. Where the tree moves, x(t) = base + V t + turn(+angle t) offset; where the
/// field moves, x(t) = base + turn(-angle t) (offset - V t).
struct Way {
  bool field_moves;
  Triple<double> base, velocity, axis;
  double angle_rad;   ///< during the whole time; negative where the field moves
  double straight;    ///< the velocity's length
  DoublePlace start;  ///< from the tree's body to offsets

  STANDOFF_INLINE Triple<double> offset(const Triple<double>& point) const { return placed(start, point); }
  STANDOFF_INLINE Triple<double> at(const Triple<double>& offset, double t) const {
    const Triple<double> from = field_moves ? offset - velocity * t : offset;
    const double angle = angle_rad * t;
    const Triple<double> there = angle == 0 ? from : turned(from, axis, __builtin_cos(angle), __builtin_sin(angle));
    return field_moves ? base + there : base + velocity * t + there;
  }
  /// The farthest the point gets from the axis it turns about: that axis moves straight, so one end or the other. The
  /// axis may be longer than it should be by what rotations are off.
  STANDOFF_INLINE double from_axis(const Triple<double>& offset) const {
    if (angle_rad == 0) return 0;
    const double at_start = length(plain_cross(axis, offset));
    const double away = field_moves ? max(at_start, length(plain_cross(axis, offset - velocity))) : at_start;
    return away * (1 + 4 * kRigidTolerance);
  }
  /// The point moves no faster than this at any time, in world units per unit of time.
  STANDOFF_INLINE double speed(const Triple<double>& offset) const {
    return straight + abs(angle_rad) * from_axis(offset);
  }
  /// Nor does its velocity change faster than this.
  STANDOFF_INLINE double acceleration(const Triple<double>& offset) const {
    const double rate = abs(angle_rad);
    return rate * (rate * from_axis(offset) + (field_moves ? 2 * straight : 0));
  }
};

// A triangle followed exactly looks this many field spacings ahead.
inline constexpr double kAhead = 1.0;

// A ball goes on as long as its steps are longer than this share of its radius: smaller steps cost more than asking its
// sixteen children. A triangle's own ball has none, it stops at a share of the field's spacing.
inline constexpr float kWorthAStep = 0.5f;
inline constexpr float kWorthATrianglesStep = 0.25f;

/// A ball on its way: free until `time`, up to which nothing touches it.
struct MovingBall {
  Triple<double> offset;
  double speed, time;
  float radius;

  /// Takes the step that a lower bound of the distance allows, less `keep`. Whether another one is worth it.
  STANDOFF_INLINE bool step(float gap, float keep, double end, float least) {
    // Far away single precision errs in proportion to the distance.
    const float way = gap * (1 - 1e-6f) - keep;
    const double before = time;
    if (way > 0) time = speed > 0 ? before + way / speed : 2;
    return time > before && time < end && way > max(kWorthAStep * radius, least);
  }
};

}  // namespace standoff::collision
