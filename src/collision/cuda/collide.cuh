// SPDX-License-Identifier: Apache-2.0
// Exact collide() for many poses: a warp per pose. It tests the probe's bounding spheres in the target's field, two
// packets of sixteen at a time, the nearest first. A packet of triangles that reaches the surface descends the target's
// BVH. Pairs whose boxes overlap are collected until there is one for each lane, then decided in double precision. The
// bounds, the decision and the slack of single precision equal the CPU's (kernel_data.h, triangle_overlap.h).
#pragma once

#include "collision/body/kernel_data.h"
#include "collision/cuda/queries.cuh"
#include "geometry/triangle_overlap.h"

namespace standoff::STANDOFF_PLATFORM {

using collision::DeviceVerdict;
using collision::PoseAnswer;
using collision::PoseQuery;

inline constexpr unsigned kCollideThreads = 128;

struct CollideTask {
  DeviceBodyView target, probe;
  bool target_is_b;
  DoubleTransform of_a;
  double margin;
  const PoseQuery* queries;
  PoseAnswer* answers;
  std::uint32_t count;
  std::uint32_t* next;  ///< the first query that no warp has taken
  int stack;
};

/// A warp's part of shared memory.
struct SearchShared {
  static constexpr int kWaiting = 64;  // 31 pairs, and 32 that the lanes add
  std::uint32_t nodes[collision::kDeviceStack], target_nodes[collision::kDeviceStack];
  float gap[32];
  FlatBox box[kLanes], all;  // around the transformed triangles
  std::uint32_t of_target[kWaiting], of_probe[kWaiting];
};

class PoseSearch {
  using Nodes = NodeStack<std::uint32_t>;

 public:
  STANDOFF_DEVICE PoseSearch(const CollideTask& task, const PoseQuery& query, SearchShared& shared)
      : task_(task), query_(query), shared_(shared), lane_(lane_in_warp()) {}

  STANDOFF_DEVICE PoseAnswer run() {
    Nodes nodes(shared_.nodes, task_.stack, packet_word(task_.probe.top, 0));
    while (!nodes.empty() && verdict_ != DeviceVerdict::hit && verdict_ != DeviceVerdict::overflow) {
      // Go on if undecided: a later pair may intersect for certain.
      const bool triangles = nodes.top_level() == 0;
      const std::uint32_t word = nodes.take(triangles ? kMostLevels : 1, kNoPacket);
      if (triangles)
        test_packet(packet_of(__shfl_sync(kWarp, word, 0)));
      else
        open(nodes, word);
    }
    return {verdict_, of_target_, of_probe_};
  }

 private:
  STANDOFF_DEVICE float transformed(int axis, float x, float y, float z) const {
    return collision::transformed(query_.transform, axis, x, y, z);
  }

  // Pushes the packets of the nodes whose spheres are near, the nearest on top.
  STANDOFF_DEVICE void open(Nodes& nodes, std::uint32_t word) {
    const int level = level_of(word), n = static_cast<int>(lane_ % kLanes);
    float gap = collision::kInfinity;
    if (word != kNoPacket) {
      const collision::Sphere16& spheres = task_.probe.spheres[level][packet_of(word)];
      const float x = spheres.center[0][n], y = spheres.center[1][n], z = spheres.center[2][n];
      gap = collision::gap_of_sphere(task_.target.field, transformed(0, x, y, z), transformed(1, x, y, z),
                                     transformed(2, x, y, z), spheres.radius[n], query_.limit);
    }
    const bool near = gap <= query_.limit;
    const std::uint32_t lanes = __ballot_sync(kWarp, near);
    const int farther = larger_keys(lanes, gap, shared_.gap);
    if (!nodes.put(lanes, farther, packet_word(level - 1, packet_of(word) * kLanes + n)))
      verdict_ = DeviceVerdict::overflow;
  }

  // Tests the packet's triangles against the target's triangles.
  STANDOFF_DEVICE void test_packet(std::uint32_t packet) {
    transform_boxes(packet);
    int waiting = 0;
    const auto use = [&](bool near, std::uint32_t index, const FlatBox& box) {
      for (int t = 0; t < kLanes; ++t) {
        const bool overlapping = near && overlap(box, shared_.box[t]);
        const std::uint32_t lanes = __ballot_sync(kWarp, overlapping);
        if (lanes == 0) continue;
        if (overlapping) {
          const int at = waiting + __popc(lanes & lanes_below(lane_));
          shared_.of_target[at] = index, shared_.of_probe[at] = packet * kLanes + static_cast<std::uint32_t>(t);
        }
        waiting += __popc(lanes);
        __syncwarp();
        if (waiting < 32) continue;
        waiting -= 32;
        settle(waiting, 32);
        if (verdict_ == DeviceVerdict::hit) return false;
      }
      return true;
    };
    if (!for_overlapping_boxes(shared_.all, task_.target, shared_.target_nodes, task_.stack, use))
      verdict_ = DeviceVerdict::overflow;
    else if (waiting > 0 && verdict_ != DeviceVerdict::hit)
      settle(0, waiting);
  }

  // Computes the boxes of a packet's triangles in the target's frame, grown by the limit, and the box around them.
  STANDOFF_DEVICE void transform_boxes(std::uint32_t packet) {
    const collision::Triangle16& triangles = task_.probe.triangles[packet];
    if (lane_ < kLanes) {
      const bool exists = packet * kLanes + lane_ < task_.probe.triangle_count;
      for (int axis = 0; axis < 3; ++axis) {
        float low = collision::kInfinity, high = -collision::kInfinity;
        for (int k = 0; k < 3 && exists; ++k) {
          const float(&corner)[3][kLanes] = triangles.corner[k];
          const float at = transformed(axis, corner[0][lane_], corner[1][lane_], corner[2][lane_]);
          low = min(at, low), high = max(at, high);
        }
        shared_.box[lane_].side[axis] = low - query_.limit, shared_.box[lane_].side[3 + axis] = high + query_.limit;
      }
    }
    __syncwarp();
    if (lane_ < 6) {
      float side = shared_.box[0].side[lane_];
      for (int n = 1; n < kLanes; ++n)
        side = lane_ < 3 ? min(side, shared_.box[n].side[lane_]) : max(side, shared_.box[n].side[lane_]);
      shared_.all.side[lane_] = side;
    }
    __syncwarp();
  }

  // Decides `count` of the waiting pairs, from `first` on, one per lane.
  STANDOFF_DEVICE void settle(int first, int count) {
    bool hit = false, unsure = false;
    std::uint32_t of_target = 0, of_probe = 0;
    if (static_cast<int>(lane_) < count) {
      of_target = shared_.of_target[first + lane_], of_probe = shared_.of_probe[first + lane_];
      Triple<double> p[3], q[3];
      load_corners(task_.target, of_target, p);
      load_corners(task_.probe, of_probe, q);
      const DoubleTransform& of_p = task_.target_is_b ? query_.of_b : task_.of_a;
      const DoubleTransform& of_q = task_.target_is_b ? task_.of_a : query_.of_b;
      for (int k = 0; k < 3; ++k) p[k] = standoff::transformed(of_p, p[k]), q[k] = standoff::transformed(of_q, q[k]);
      const TriangleOverlap<double> overlap = triangle_overlap(p, q);
      hit = overlap.intersecting, unsure = overlap.unsure;
      if (!hit && task_.margin > 0) hit = closest_pair(p, q).distance_sq <= task_.margin * task_.margin;
    }
    const std::uint32_t hits = __ballot_sync(kWarp, hit);
    if (hits != 0) {
      const int one = __ffs(static_cast<int>(hits)) - 1;
      of_target_ = __shfl_sync(kWarp, of_target, one), of_probe_ = __shfl_sync(kWarp, of_probe, one);
      verdict_ = DeviceVerdict::hit;
    } else if (__ballot_sync(kWarp, unsure) != 0) {
      verdict_ = DeviceVerdict::undecided;
    }
    // Order memory, which votes do not: other lanes write the next pairs over these.
    __syncwarp();
  }

  const CollideTask& task_;
  const PoseQuery& query_;
  SearchShared& shared_;
  const std::uint32_t lane_;
  // The same in all lanes.
  DeviceVerdict verdict_ = DeviceVerdict::free;
  std::uint32_t of_target_ = 0, of_probe_ = 0;
};

/// Warps take one pose after another.
__global__ void __launch_bounds__(kCollideThreads) collide_poses(CollideTask task) {
  __shared__ SearchShared shared[kCollideThreads / 32];
  answer_queries<PoseSearch>(task, shared);
}

/// Decides a batch on the current device.
inline void run_collide(const collision::CollideJob& job, Backend backend) {
  const auto target = device_body_of(job.target, backend, job.device),
             probe = device_body_of(job.probe, backend, job.device);
  run_queries<kCollideThreads>(
      "collide_poses", collide_poses, job.queries, job.answers,
      [&](const PoseQuery* queries, PoseAnswer* answers, std::uint32_t count, std::uint32_t* next) {
        return CollideTask{target->view(), probe->view(), job.target_is_b, job.of_a, job.margin,
                           queries,        answers,       count,           next,     job.stack};
      });
}

}  // namespace standoff::STANDOFF_PLATFORM
