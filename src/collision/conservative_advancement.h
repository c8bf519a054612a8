// SPDX-License-Identifier: Apache-2.0
// The rigid motion of the probe in the target's frame, and the steps and bounds of conservative advancement along it.
// The CPU and GPUs share the spheres; the paths of triangles are for GPUs, as CPUs advance pairs of boxes instead
// (moving_nodes.h). docs/collision_methods.md proves the bounds. This work is based on: Mirtich, Impulse-based
// Dynamic Simulation of Rigid Body Systems (1996); Tang, Kim, Manocha, C2A: Controlled Conservative Advancement for
// Continuous Collision Detection of Polygonal Models (2009).
//
// Let a bounding sphere (c, r) have its centre at distance L or more from the surface at time t, and let `speed` bound
// the speed of the centre at all times. Then the sphere is free until t + (L - r - keep) / speed: distance is
// 1-Lipschitz, and rotation about its own centre does not move a sphere. A child sphere may start at the time up to
// which its parent is free: its triangles are in the parent too.
#pragma once

#include "collision/body/kernel_data.h"
#include "collision/tolerances.h"
#include "geometry/triangle_overlap.h"
#include "standoff/pose.h"

namespace standoff::collision {

/// Rotates v about a unit axis (Rodrigues' formula).
STANDOFF_INLINE Triple<double> rotated(const Triple<double>& v, const Triple<double>& axis, double cosine,
                                       double sine) {
  return v * cosine + plain_cross(axis, v) * sine + axis * (plain_dot(axis, v) * (1 - cosine));
}
STANDOFF_INLINE double length(const Triple<double>& v) { return sqrt(plain_dot(v, v)); }

/// The motion of points of the probe in the frame of the target, relative to the bodies' middles. A point is given by
/// its offset from a base point at time 0. If the probe moves, x(t) = base + V t + rotation(+angle t) offset; if the
/// target moves, x(t) = base + rotation(-angle t) (offset - V t).
struct RelativeMotion {
  bool target_moves;
  Triple<double> base, velocity, axis;
  double angle_rad;       ///< of the whole motion; negative if the target moves
  double speed_of_base;   ///< the length of the velocity
  DoubleTransform start;  ///< from the probe's coordinates to offsets

  STANDOFF_INLINE Triple<double> offset(const Triple<double>& point) const { return transformed(start, point); }
  STANDOFF_INLINE Triple<double> at(const Triple<double>& offset, double t) const {
    const Triple<double> from = target_moves ? offset - velocity * t : offset;
    const double angle = angle_rad * t;
    const Triple<double> there = angle == 0 ? from : rotated(from, axis, __builtin_cos(angle), __builtin_sin(angle));
    return target_moves ? base + there : base + velocity * t + there;
  }
  /// The largest distance of a point from the axis of rotation at any time. The axis moves along a straight line, so
  /// the largest distance is at one end. Accounts for the rounding error of the axis' length.
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

/// A bounding sphere in motion: it touches nothing until `time`.
struct MovingSphere {
  Triple<double> offset;  ///< of its centre: RelativeMotion
  double speed, time;

  /// Takes the step that `gap`, a lower bound of the distance, allows, and leaves `keep` of the distance. True if
  /// another step pays: the sphere has not reached `end`, and the step was longer than `worthwhile`.
  STANDOFF_INLINE bool step(float gap, float keep, double end, float worthwhile) {
    const float distance = gap * kRoundDown - keep;
    const double before = time;
    if (distance > 0) time = speed > 0 ? before + distance / speed : kNever;
    return time > before && time < end && distance > worthwhile;
  }
};

/// Advances a sphere by the field until its steps are no longer worthwhile; returns a time until which it stays free.
STANDOFF_INLINE double advanced(MovingSphere sphere, float radius, const RelativeMotion& motion, const FieldView& field,
                                float keep, double end, float worthwhile) {
  for (bool goes_on = true; goes_on;) {
    const Triple<double> x = motion.at(sphere.offset, sphere.time);
    const float gap = gap_of_sphere(field, static_cast<float>(x.x), static_cast<float>(x.y), static_cast<float>(x.z),
                                    radius, field.spacing);
    goes_on = sphere.step(gap, keep, end, worthwhile);
  }
  return sphere.time;
}

/// A triangle of the probe in motion.
struct MovingTriangle {
  Triple<double> offset[3];
  double radius, speed, acceleration;  ///< upper bounds for all corners; the radius is about the base point
};

/// The triangle with the given corners, relative to the probe's middle.
STANDOFF_INLINE MovingTriangle moving_triangle(const RelativeMotion& motion, const Triple<double> (&corner)[3]) {
  MovingTriangle t{};
  for (int k = 0; k < 3; ++k) {
    t.offset[k] = motion.offset(corner[k]);
    t.radius = max(t.radius, length(t.offset[k]));
    t.speed = max(t.speed, motion.speed(t.offset[k]));
    t.acceleration = max(t.acceleration, motion.acceleration(t.offset[k]));
  }
  return t;
}

/// The end of the interval in which a triangle that stopped at `t` is tested against the target's triangles.
STANDOFF_INLINE double look_ahead(double t, double speed, double spacing) {
  return speed > 0 ? t + kLookAhead * spacing / speed : kNever;
}

/// An upper bound of the distance of a path from its chord: acceleration * dt^2 / 8.
STANDOFF_INLINE float chord_deviation(double acceleration, double duration) {
  return static_cast<float>(acceleration * duration * duration / 8) * kRoundUp;
}

/// A box around the triangle between two times, grown by `by`: the box of its corners at both times, grown by the
/// deviation of their paths from the chords.
STANDOFF_INLINE void swept_bounds(const RelativeMotion& motion, const MovingTriangle& triangle, double t, double until,
                                  float by, float (&low)[3], float (&high)[3]) {
  const float grown = by + chord_deviation(triangle.acceleration, until - t);
  for (int axis = 0; axis < 3; ++axis) low[axis] = __builtin_inff(), high[axis] = -__builtin_inff();
  for (int k = 0; k < 6; ++k) {
    const Triple<double> x = motion.at(triangle.offset[k % 3], k < 3 ? t : until);
    const float at[3] = {static_cast<float>(x.x), static_cast<float>(x.y), static_cast<float>(x.z)};
    for (int axis = 0; axis < 3; ++axis) low[axis] = min(at[axis], low[axis]), high[axis] = max(at[axis], high[axis]);
  }
  for (int axis = 0; axis < 3; ++axis) low[axis] -= grown, high[axis] += grown;
}

/// An upper bound of the speed along the unit vector `normal` of points within `radius` of the unit vector `axis` that
/// rotate about it at `rate`.
STANDOFF_INLINE double rotation_speed_along(const Triple<double>& normal, const Triple<double>& axis, double rate,
                                            double radius) {
  return rate == 0 ? 0 : length(plain_cross(normal, axis)) * rate * radius;
}

}  // namespace standoff::collision
