// SPDX-License-Identifier: Apache-2.0
// Relative rigid motion of the probe in the target's frame: plain numbers, shared by the CPU and GPUs.
#pragma once

#include "geometry/triangle_overlap.h"
#include "standoff/pose.h"

namespace standoff::collision {

/// v turned about a unit axis (Rodrigues' formula).
STANDOFF_INLINE Triple<double> rotated(const Triple<double>& v, const Triple<double>& axis, double cosine,
                                       double sine) {
  return v * cosine + plain_cross(axis, v) * sine + axis * (plain_dot(axis, v) * (1 - cosine));
}
STANDOFF_INLINE double length(const Triple<double>& v) { return sqrt(plain_dot(v, v)); }

/// The motion of points of the probe in the frame of the target, relative to the models' middles. A point is given by
/// its offset from a base point at time 0. Where the probe moves, x(t) = base + V t + rotation(+angle t) offset; where
/// the target moves, x(t) = base + rotation(-angle t) (offset - V t).
struct RelativeMotion {
  bool target_moves;
  Triple<double> base, velocity, axis;
  double angle_rad;       ///< during the whole time; negative where the target moves
  double speed_of_base;   ///< the velocity's length
  DoubleTransform start;  ///< from the probe's coordinates to offsets

  STANDOFF_INLINE Triple<double> offset(const Triple<double>& point) const { return transformed(start, point); }
  STANDOFF_INLINE Triple<double> at(const Triple<double>& offset, double t) const {
    const Triple<double> from = target_moves ? offset - velocity * t : offset;
    const double angle = angle_rad * t;
    const Triple<double> there = angle == 0 ? from : rotated(from, axis, __builtin_cos(angle), __builtin_sin(angle));
    return target_moves ? base + there : base + velocity * t + there;
  }
  /// The largest distance of a point from the axis of rotation. That axis moves on a straight line, so it is reached at
  /// one end. The axis may be longer than it should be by what rotations may be off.
  STANDOFF_INLINE double from_axis(const Triple<double>& offset) const {
    if (angle_rad == 0) return 0;
    const double at_start = length(plain_cross(axis, offset));
    const double away = target_moves ? max(at_start, length(plain_cross(axis, offset - velocity))) : at_start;
    return away * (1 + 4 * kRigidTolerance);
  }
  /// An upper bound of the point's speed, in world units per unit of time.
  STANDOFF_INLINE double speed(const Triple<double>& offset) const {
    return speed_of_base + abs(angle_rad) * from_axis(offset);
  }
  /// An upper bound of its acceleration.
  STANDOFF_INLINE double acceleration(const Triple<double>& offset) const {
    const double rate = abs(angle_rad);
    return rate * (rate * from_axis(offset) + (target_moves ? 2 * speed_of_base : 0));
  }
};

}  // namespace standoff::collision
