// SPDX-License-Identifier: Apache-2.0
// Sweeps for many motions at once, on a device.
#pragma once

#include <vector>

#include "collision/device.h"

namespace standoff::collision {

/// The device finds motions that are certainly free; the CPU sweeps the others, and `report` counts them. Requires
/// motions and a tolerance that sweep_all() has checked.
std::vector<SweepResult> sweep_on_device(const DeviceRow& row, const CollisionModel& a, const Pose& pose_a,
                                         const CollisionModel& b, std::span<const RigidMotion> motions,
                                         double tolerance, const Execution& execution, BatchReport& report,
                                         int stack = kDeviceStack);

}  // namespace standoff::collision
