// SPDX-License-Identifier: Apache-2.0
// Which body lies inside which, where their surfaces do not intersect.
#pragma once

#include "standoff/collision.h"

namespace standoff::collision {

/// Throws Error{input} unless at least one of the bodies is closed.
void require_closed(const CollisionModel& a, const CollisionModel& b);

/// Requires surfaces that do not intersect.
Containment containment(const CollisionModel& a, const Pose& pose_a, const CollisionModel& b, const Pose& pose_b);

}  // namespace standoff::collision
