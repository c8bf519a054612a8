// SPDX-License-Identifier: Apache-2.0
// Exact collide() for many poses at once, on a device.
#pragma once

#include <vector>

#include "collision/device.h"

namespace standoff::collision {

/// The device decides what it can, the CPU decides the others; `report` counts both. Requires poses that collide_all()
/// has checked.
std::vector<CollisionResult> collide_on_device(const DeviceRow& row, const CollisionModel& a, const Pose& pose_a,
                                               const CollisionModel& b, std::span<const Pose> poses_b, double margin,
                                               const Execution& execution, BatchReport& report,
                                               int stack = kDeviceStack);

}  // namespace standoff::collision
