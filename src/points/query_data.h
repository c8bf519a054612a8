// SPDX-License-Identifier: Apache-2.0
// What a MeshQuery has prepared.
#pragma once

#include <memory>
#include <mutex>
#include <optional>

#include "points/device.h"
#include "points/point_sign.h"
#include "points/triangle_index.h"
#include "sign/plan.h"
#include "standoff/points.h"

namespace standoff {

struct MeshQuery::Data {
  /// Requires a valid mesh within kMaxCoordinate, and a plan that fits it. Runs on the threads of the calling TBB
  /// arena. `while_built` is called many times before it is done, and may throw to end that.
  Data(Mesh mesh, const SignOptions& sign, SignPlan plan, int threads, Simd simd,
       const ProgressCallback& while_built = {});

  /// Of the triangles that count for distances: with SignOptions::outer not all, and no copies where they are many.
  const TriangleIndex& near() const { return counting ? *counting : *all; }

  /// What a device is given of near(); made on first use.
  const DeviceTree& device_tree() const;

  Mesh mesh;
  SignOptions sign;
  SignPlan plan;
  std::vector<std::uint32_t> distinct;  ///< of plan.exposed, or of all, those without copies of others; empty: the same
  std::optional<TriangleIndex> all, counting;
  std::unique_ptr<SidesOfPoints> sides;

 private:
  mutable std::mutex tree_mutex_;
  mutable std::unique_ptr<const DeviceTree> tree_;
};

}  // namespace standoff
