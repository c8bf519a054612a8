// SPDX-License-Identifier: Apache-2.0
// The nearest triangles of many points, found by a device.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "points/device.h"
#include "points/nearest.h"

namespace standoff {

/// As find_nearest() of nearest.h, with the same bits. The tree is that of the index; `number` says which device.
void find_nearest_on_device(const PointDevice& device, int number, const DeviceTree& tree, const TriangleIndex& index,
                            std::span<const Vec3> points, FoundTriangles& found, ProgressMeter& progress);

}  // namespace standoff
