// SPDX-License-Identifier: Apache-2.0
// Conservative advancement of the probe's BVH through the target's distance field.
#pragma once

#include "collision/rigid_motion.h"

namespace standoff::collision {

/// The first contact of a motion, on which the bodies are kept half of `tolerance` apart; free where there is none.
SweepResult first_contact(const QueryPair& pair, const AxisAngleMotion& path, double tolerance);

}  // namespace standoff::collision
