// SPDX-License-Identifier: Apache-2.0
// The parts of distance(): one query on the CPU, and batches of poses on a device.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "collision/device.h"
#include "collision/query_pair.h"
#include "standoff/collision.h"

namespace standoff::collision {

/// Two triangles by their BVH indices, and their closest points.
struct NearestPair {
  std::uint32_t of_target, of_probe;
  Vec3 on_target, on_probe;
};

/// The answer that a search for the nearest pair gives.
DistanceResult result_of(const QueryPair& pair, const NearestPair& nearest, double lower, double upper);
/// The answer where no pair is nearer than the limit.
DistanceResult beyond(double limit);

/// distance() on the CPU, without its checks.
DistanceResult distance_exactly(const Body& a, const Pose& pose_a, const Body& b, const Pose& pose_b,
                                const DistanceOptions& options, const Kernels& kernels, DistanceState& state);

DistanceQuery query_of(const QueryPair& pair);

/// distance_exactly() for many poses at once, without a tolerance and without most steps. The device finds the nearest
/// pairs; the CPU decides poses that may intersect, and those where the pair that it reports may be another one of
/// equally near ones. `report` counts both. Requires poses that distance_all() has checked.
std::vector<DistanceResult> distance_on_device(const DeviceRow& row, const Body& a, const Pose& pose_a, const Body& b,
                                               std::span<const Pose> poses_b, double limit, const Execution& execution,
                                               BatchReport& report, const DistanceLists& lists = {});

}  // namespace standoff::collision
