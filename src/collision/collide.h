// SPDX-License-Identifier: Apache-2.0
// The CPU's answer to one exact collide().
#pragma once

#include "collision/cpu/kernels.h"
#include "standoff/collision.h"

namespace standoff::collision {

/// collide() without its checks.
CollisionResult collide_exactly(const CollisionModel& a, const Pose& pose_a, const CollisionModel& b,
                                const Pose& pose_b, double margin, const Kernels& kernels);

}  // namespace standoff::collision
