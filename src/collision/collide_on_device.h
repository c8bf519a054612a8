// Yes or no for many poses at once, on a device.
#pragma once

#include <vector>

#include "collision/device.h"

namespace standoff::collision {

/// What the device decides; the others go to the CPU, and are counted. Poses must be valid.
std::vector<CollisionResult> collide_on_device(const DeviceRow& row, const CollisionModel& a, const Pose& pose_a,
                                               const CollisionModel& b, std::span<const Pose> poses_b, double margin,
                                               const Execution& execution, BatchReport& report,
                                               int stack = kDeviceStack);

/// The answer of the CPU.
CollisionResult collide_exactly(const CollisionModel& a, const Pose& pose_a, const CollisionModel& b,
                                const Pose& pose_b, double margin);

}  // namespace standoff::collision
