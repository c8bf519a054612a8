// SPDX-License-Identifier: Apache-2.0
// The nearest triangles of points on a GPU: a thread per point walks the tree, the nearer child first. Distances of
// boxes are lower bounds in float. Triangles are measured in double by the CPU's own arithmetic
// (geometry/triangle_distance.h), and the lowest index wins among equally near ones. So the bits equal the CPU's, in
// whatever order boxes are visited.
//
// Each point has a thread, not a warp: queries take about the same time, there are enough of them to fill a GPU, and
// sorted points make the threads of a warp visit the same nodes.
#pragma once

#include <limits>
#include <memory>

#include "geometry/triangle_distance.h"
#include "gpu/devices.h"
#include "gpu/platform.cuh"
#include "points/device.h"
#include "standoff/mesh.h"

namespace standoff::STANDOFF_PLATFORM {

inline constexpr unsigned kNearestThreads = 128;

/// The kernel's arguments. Pointers are to device memory.
struct NearestTask {
  const DeviceTree::Node* nodes;
  const double* corners;  ///< nine numbers per entry
  const std::uint32_t* indices;
  std::uint32_t triangles, leaves;
  double center[3], scale;
  float extent;
  const Vec3* points;
  DeviceNearest* found;
  std::int64_t count;
};

class NearestSearch {
 public:
  STANDOFF_DEVICE NearestSearch(const NearestTask& task, const Vec3& point)
      : task_(task), point_{point.x, point.y, point.z} {
    const double world[3] = {point.x, point.y, point.z};
    float farthest = task.extent;
    for (int axis = 0; axis < 3; ++axis) {
      local_[axis] = static_cast<float>((world[axis] - task.center[axis]) * task.scale);
      farthest = max(farthest, abs(local_[axis]));
    }
    slack_ = 2 * farthest * kSlack;
  }

  STANDOFF_DEVICE DeviceNearest run() {
    Waiting waiting[kMostWaiting];
    int count = 0;
    std::uint32_t node = 1;
    for (;;) {
      if (node >= task_.leaves) {
        look_at(node - task_.leaves);
      } else {
        const float left = box_distance_sq(2 * node), right = box_distance_sq(2 * node + 1);
        const bool left_first = left <= right;
        const float near = left_first ? left : right, far = left_first ? right : left;
        if (far <= best_bound_) waiting[count++] = {far, left_first ? 2 * node + 1 : 2 * node};
        if (near <= best_bound_) {
          node = left_first ? 2 * node : 2 * node + 1;
          continue;
        }
      }
      do {
        if (count == 0) return best_;
      } while (waiting[--count].distance_sq > best_bound_);
      node = waiting[count].node;
    }
  }

 private:
  struct Waiting {
    float distance_sq;
    std::uint32_t node;
  };
  // One for each level above the leaves; there are at most 2^30 leaves.
  static constexpr int kMostWaiting = 32;
  // A share of the largest coordinate: four times the error of rounding a point to float, and far more than the error
  // of a distance in double.
  static constexpr float kSlack = 0x1p-22f;
  // A share of a squared distance: covers its float arithmetic, and the rounding of the best distance to float.
  static constexpr float kShare = 0x1p-20f;

  // A lower bound of the squared distances of the node's triangles.
  STANDOFF_DEVICE float box_distance_sq(std::uint32_t node) const {
    const DeviceTree::Node& box = task_.nodes[node];
    float sum = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const float outside = max(box.low[axis] - local_[axis], local_[axis] - box.high[axis]);
      const float least = max(outside - slack_, 0.0f);
      sum = sum + least * least;
    }
    return sum * (1 - kShare);
  }

  STANDOFF_DEVICE void look_at(std::uint32_t leaf) {
    const std::uint64_t first = std::uint64_t{leaf} * DeviceTree::kLeaf;
    for (std::uint64_t entry = first; entry < first + DeviceTree::kLeaf && entry < task_.triangles; ++entry) {
      const double* const t = task_.corners + 9 * entry;
      Triple<double> corner[3];
      for (int n = 0; n < 3; ++n)
        corner[n] = {(t[3 * n] - point_.x) * task_.scale, (t[3 * n + 1] - point_.y) * task_.scale,
                     (t[3 * n + 2] - point_.z) * task_.scale};
      const double sq = origin_distance_sq(corner[0], corner[1], corner[2]);
      const std::uint32_t triangle = task_.indices[entry];
      if (sq > best_.distance_sq || (sq == best_.distance_sq && triangle > best_.triangle)) continue;
      best_ = {sq, triangle};
      best_bound_ = static_cast<float>(sq) * (1 + kShare);
    }
  }

  const NearestTask& task_;
  Triple<double> point_;
  float local_[3], slack_;
  DeviceNearest best_{std::numeric_limits<double>::infinity(), kNoTriangle};
  float best_bound_ = std::numeric_limits<float>::infinity();  // at least best_.distance_sq
};

STANDOFF_KERNEL void __launch_bounds__(kNearestThreads) nearest_triangles(NearestTask task) {
  const std::int64_t n = std::int64_t{blockIdx.x} * kNearestThreads + threadIdx.x;
  if (n < task.count) task.found[n] = NearestSearch(task, task.points[n]).run();
}

/// A tree in device memory.
class DeviceTreeCopy : public gpu::DeviceCopy {
 public:
  explicit DeviceTreeCopy(const DeviceTree& tree) {
    gpu::Workspace measure(nullptr);
    lay_out(tree, measure);
    memory_ = Memory(measure.used());
    gpu::Workspace arrays(memory_.as<void>());
    lay_out(tree, arrays);
    const auto count = std::int64_t{tree.triangles};
    copy_in(nodes_, tree.nodes.data(), static_cast<std::int64_t>(tree.nodes.size() * sizeof(DeviceTree::Node)));
    copy_in(corners_, tree.corners.data(), 9 * count * static_cast<std::int64_t>(sizeof(double)));
    copy_in(indices_, tree.indices, count * static_cast<std::int64_t>(sizeof(std::uint32_t)));
  }

  NearestTask task(const DeviceTree& tree) const {
    return {nodes_,
            corners_,
            indices_,
            tree.triangles,
            tree.leaves,
            {tree.center[0], tree.center[1], tree.center[2]},
            tree.scale,
            tree.extent,
            nullptr,
            nullptr,
            0};
  }

 private:
  void lay_out(const DeviceTree& tree, gpu::Workspace& arrays) {
    nodes_ = arrays.take<DeviceTree::Node>(static_cast<std::int64_t>(tree.nodes.size()));
    corners_ = arrays.take<double>(9 * std::int64_t{tree.triangles});
    indices_ = arrays.take<std::uint32_t>(tree.triangles);
  }

  Memory memory_;
  DeviceTree::Node* nodes_ = nullptr;
  double* corners_ = nullptr;
  std::uint32_t* indices_ = nullptr;
};

/// Answers a job on the current device.
inline void run_nearest(const NearestJob& job, Backend backend) {
  const auto copy = std::static_pointer_cast<const DeviceTreeCopy>(
      job.tree.copies.get(backend, job.device, [&] { return std::make_shared<DeviceTreeCopy>(job.tree); }));
  const auto count = static_cast<std::int64_t>(job.points.size());
  const Memory points(static_cast<std::int64_t>(job.points.size_bytes())),
      found(static_cast<std::int64_t>(job.found.size_bytes()));
  copy_in(points.as<void>(), job.points.data(), static_cast<std::int64_t>(job.points.size_bytes()));
  NearestTask task = copy->task(job.tree);
  task.points = points.as<Vec3>();
  task.found = found.as<DeviceNearest>();
  task.count = count;
  launch(nullptr, "nearest_triangles", nearest_triangles, (count + kNearestThreads - 1) / kNearestThreads,
         kNearestThreads, task);
  copy_out(job.found.data(), found.as<void>(), static_cast<std::int64_t>(job.found.size_bytes()));
}

}  // namespace standoff::STANDOFF_PLATFORM
