// Sweeps for many motions at once, on a device.
#pragma once

#include <vector>

#include "collision/device.h"
#include "collision/rigid_motion.h"

namespace standoff::collision {

/// The tolerance asked for, or the least that can be kept where the poses and corners are rounded by more than that.
double tolerance_kept(const Pair& pair, const Course& course, double asked);

/// The distance that a ball leaves between itself and the surface after every step.
float distance_kept(const Pair& pair, const Course& course, double tolerance);

/// Whether the last pose, a rotation only nearly, lies so far from where the even turn leads that it must be looked at.
bool may_jump_at_end(const Course& course, const CollisionModel& moving, double tolerance);

/// The CPU's answer.
SweepResult sweep_exactly(const CollisionModel& a, const Pose& pose_a, const CollisionModel& b,
                          const RigidMotion& motion, double tolerance);

/// What is certainly free the device decides; the others go to the CPU, and are counted. Motions must be valid.
std::vector<SweepResult> sweep_on_device(const DeviceRow& row, const CollisionModel& a, const Pose& pose_a,
                                         const CollisionModel& b, std::span<const RigidMotion> motions,
                                         double tolerance, const Execution& execution, BatchReport& report,
                                         int stack = kDeviceStack);

}  // namespace standoff::collision
