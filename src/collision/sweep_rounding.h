// SPDX-License-Identifier: Apache-2.0
// What rounding does to bodies in motion, and how far they are kept apart because of it.
#pragma once

#include "collision/rigid_motion.h"

namespace standoff::collision {

/// Poses and corners on a motion are rounded: bodies jump by as much from one time to the next.
double pose_rounding(const QueryPair& pair, const AxisAngleMotion& path);

/// The tolerance asked for, or the least that pose_rounding() lets a sweep keep.
double tolerance_kept(const QueryPair& pair, const AxisAngleMotion& path, double asked);

/// The distance that bounding spheres leave between themselves and the surface after every step.
float distance_kept(const QueryPair& pair, const AxisAngleMotion& path, double tolerance);

/// Whether the last pose must be tested by itself: its matrix may be a rotation only nearly, and lie farther from where
/// the even rotation ends than the distance that was kept.
bool last_pose_may_jump(const AxisAngleMotion& path, const CollisionModel& moving, double tolerance);

}  // namespace standoff::collision
