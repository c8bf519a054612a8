// SPDX-License-Identifier: Apache-2.0
// The CPU's answer to one sweep.
#pragma once

#include "collision/cpu/kernels.h"
#include "standoff/collision.h"

namespace standoff::collision {

/// sweep() without its checks. The tolerance is positive.
SweepResult sweep_exactly(const CollisionModel& a, const Pose& pose_a, const CollisionModel& b,
                          const RigidMotion& motion, double tolerance, const Kernels& kernels);

}  // namespace standoff::collision
