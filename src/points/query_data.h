// SPDX-License-Identifier: Apache-2.0
// The data that a MeshQuery prepares.
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
  /// arena. Calls `while_built` many times, which may throw to stop the work.
  Data(Mesh mesh, const SignOptions& sign, SignPlan plan, int threads, Simd simd,
       const ProgressCallback& while_built = {});

  /// The index of the triangles that count for distances: SignOptions::outer excludes hidden ones, and copies of
  /// triangles are excluded if they are many.
  const TriangleIndex& near() const { return counting ? *counting : *all; }

  /// The tree of near() for a device; made on first use.
  const DeviceTree& device_tree() const;

  Mesh mesh;
  SignOptions sign;
  SignPlan plan;
  /// The triangles of plan.exposed, or of the mesh, without copies of others; empty if none is left out.
  std::vector<std::uint32_t> distinct;
  std::optional<TriangleIndex> all, counting;
  std::unique_ptr<PointSigns> signs;

 private:
  mutable std::mutex tree_mutex_;
  mutable std::unique_ptr<const DeviceTree> tree_;
};

}  // namespace standoff
