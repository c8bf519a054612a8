// SPDX-License-Identifier: Apache-2.0
// The parts of sweep(): rigid motions in the world and in the frame of a pair's target, bounds of their rounding, the
// search for the first contact, and batches of motions on a device.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "collision/conservative_advancement.h"
#include "collision/device.h"
#include "collision/query_pair.h"
#include "standoff/collision.h"

namespace standoff::collision {

/// A rotation about `axis` (unit length) by `angle_rad`, which is not negative, and may be many turns.
struct AxisAngle {
  Vec3 axis{0, 0, 1};
  double angle_rad = 0;
};

/// A RigidMotion, with its rotation as axis and angle.
struct AxisAngleMotion {
  RigidMotion poses;
  AxisAngle rotation;     ///< from `from` to `to`, in the world
  Vec3 center, velocity;  ///< in the world: the point that the body rotates about at time 0, and its velocity

  explicit AxisAngleMotion(const RigidMotion& motion);
  Pose at(double t) const;
};

/// Throws Error{usage} unless the motion is one that pose_at() takes. Messages begin with `what`.
void validate(const char* what, const RigidMotion& motion);

/// Throws Error{usage} if rounding of the time alone moves b by a good part of the bodies' size.
void check_length(const Body& a, const Body& b, const RigidMotion& motion, double tolerance);
/// The same for a way of this length on which b turns as in `turn`.
void check_length(const Body& a, const Body& b, double way, const RigidMotion& turn, double tolerance);

/// The motion of the pair's probe in the frame of its target.
RelativeMotion relative_motion(const QueryPair& pair, const AxisAngleMotion& path);

/// An upper bound of the jump of a body from one time to the next: poses and corners on a motion are rounded.
double pose_rounding(const QueryPair& pair, const AxisAngleMotion& path);

/// The distance that bounding spheres leave between themselves and the surface after every step.
float distance_kept(const QueryPair& pair, const AxisAngleMotion& path, double tolerance);

/// The distance that pairs of nodes leave: most of the tolerance, and what double precision may lose.
double reserve_of_nodes(const QueryPair& pair, const AxisAngleMotion& path, double tolerance);

/// How far a point of the body may be at the last pose from where the even rotation ends.
double jump_at_end(const AxisAngleMotion& path, const BodyData& body);
/// Whether the last pose must be tested by itself: its matrix may be a rotation only nearly, and lie farther from where
/// the even rotation ends than the distance that was kept, half the tolerance. (Bodies that start nearer than that and
/// only move apart are nearer still.)
bool last_pose_may_jump(const AxisAngleMotion& path, const Body& moving, double tolerance);

/// Throws Error{usage} unless the time is from 0 to 1.
void validate_time(double t);

/// Finds the first contact of a motion, or free. The bodies are kept half of `tolerance` apart. Ends unfinished where
/// the steps are taken.
SweepResult first_contact(const QueryPair& pair, const AxisAngleMotion& path, double tolerance, Steps& steps);

/// sweep() without its checks, on the CPU. The tolerance is positive.
SweepResult sweep_exactly(const Body& a, const Pose& pose_a, const Body& b, const RigidMotion& motion,
                          double asked_tolerance, Steps& steps, const Kernels& kernels);

/// Checks the options of a sweep, and returns the tolerance, which is positive.
double checked_tolerance(const Body& a, const Body& b, const SweepOptions& options);

/// The rotation `matrix`, then one by `angle_rad` about a unit axis.
std::array<double, 9> turned(const std::array<double, 9>& matrix, Vec3 axis, double angle_rad);

/// Axis and angle, with an angle that is not negative. The axis may have any length but zero.
AxisAngle axis_angle_of(Vec3 axis, double angle_rad);

/// A hit at a time at which the bodies are this near.
SweepResult hit_at(double t, const DistanceResult& nearest);

/// Sweeps for many motions at once. The device finds motions that are certainly free; the CPU sweeps the others, and
/// `report` counts them. Requires motions and options that sweep_all() has checked, with a positive tolerance.
std::vector<SweepResult> sweep_on_device(const DeviceRow& row, const Body& a, const Pose& pose_a, const Body& b,
                                         std::span<const RigidMotion> motions, const SweepOptions& options,
                                         const Execution& execution, BatchReport& report, int stack = kDeviceStack);

}  // namespace standoff::collision
