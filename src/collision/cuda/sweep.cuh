// SPDX-License-Identifier: Apache-2.0
// Finds motions that are certainly free, a warp per motion. The probe's bounding spheres are advanced, two packets of
// sixteen at a time, the packet that stopped at the earliest time first; their children start from there. Triangles
// that stop are tested, one target triangle per lane, against the triangles that overlap the box they sweep. If a pair
// comes nearer than twice the distance to be kept, the motion is undecided. Bounds and steps are the CPU's
// (conservative_advancement.h), in the target's frame; the distance kept covers its rounding.
#pragma once

#include "collision/body/kernel_data.h"
#include "collision/conservative_advancement.h"
#include "collision/cuda/queries.cuh"
#include "geometry/triangle_overlap.h"

namespace standoff::STANDOFF_PLATFORM {

using collision::DeviceVerdict;
using collision::MovingTriangle;
using collision::SweepAnswer;
using collision::SweepQuery;

inline constexpr unsigned kSweepThreads = 128;

struct SweepTask {
  DeviceBodyView target, probe;
  const SweepQuery* queries;
  SweepAnswer* answers;
  std::uint32_t count;
  std::uint32_t* next;  ///< the first query that no warp has taken
  int stack;
};

/// A warp's part of shared memory.
struct SweepShared {
  static constexpr int kWaiting = 64;  // 31 triangles, and 32 that the lanes add
  TimedPacket nodes[collision::kDeviceStack];
  std::uint32_t target_nodes[collision::kDeviceStack];
  double time[32];
  std::uint32_t of_target[kWaiting];
};

class MotionSearch {
 public:
  STANDOFF_DEVICE MotionSearch(const SweepTask& task, const SweepQuery& query, SweepShared& shared)
      : task_(task), query_(query), shared_(shared) {}

  STANDOFF_DEVICE SweepAnswer run() {
    NodeStack<TimedPacket> nodes(shared_.nodes, task_.stack, {0, packet_word(task_.probe.top, 0)});
    while (!nodes.empty() && verdict_ == DeviceVerdict::free) {
      const TimedPacket packet = nodes.take(0, {0, kNoPacket});
      const int level = level_of(packet.word);
      const std::uint32_t n = lane_in_warp() % kLanes;
      double time = collision::kNever;
      if (packet.word != kNoPacket) {
        const collision::Sphere16& spheres = task_.probe.spheres[level][packet_of(packet.word)];
        if (spheres.radius[n] >= 0)
          time = moved({spheres.center[0][n], spheres.center[1][n], spheres.center[2][n]}, spheres.radius[n],
                       packet.time, level);
      }
      const std::uint32_t child = packet_of(packet.word) * kLanes + n;
      follow_all(level == 0 && time < kEnd, child, time);
      const bool inner = level > 0 && time < kEnd;
      const std::uint32_t lanes = __ballot_sync(kWarp, inner);
      const int later = larger_keys(lanes, time, shared_.time);
      if (!nodes.put(lanes, later, {time, packet_word(level - 1, child)})) verdict_ = DeviceVerdict::overflow;
    }
    return {verdict_};
  }

 private:
  static constexpr double kEnd = 1;

  // A time until which a sphere that is free until `start` stays free.
  STANDOFF_DEVICE double moved(const Triple<double>& center, float radius, double start, int level) const {
    const collision::FieldView& field = task_.target.field;
    const float least = level == 0 ? collision::kWorthwhileTriangleStep * field.spacing : 0;
    const float worthwhile = max(collision::kWorthwhileStep * radius, least);
    const Triple<double> offset = query_.motion.offset(center);
    return collision::advanced({offset, query_.motion.speed(offset), start}, radius, query_.motion, field, query_.keep,
                               kEnd, worthwhile);
  }

  // Follows the triangles of the lanes that stopped.
  STANDOFF_DEVICE void follow_all(bool stopped, std::uint32_t index, double time) {
    for (std::uint32_t left = __ballot_sync(kWarp, stopped); left != 0 && verdict_ == DeviceVerdict::free;
         left &= left - 1) {
      const int lane = __ffs(static_cast<int>(left)) - 1;
      follow(__shfl_sync(kWarp, index, lane), __shfl_sync(kWarp, time, lane));
    }
  }

  STANDOFF_DEVICE MovingTriangle triangle_at(std::uint32_t index) const {
    Triple<double> corner[3];
    load_corners(task_.probe, index, corner);
    for (Triple<double>& c : corner) c = c - task_.probe.middle;
    return collision::moving_triangle(query_.motion, corner);
  }

  // Follows a triangle from a time at which it is free; at time 0 it may touch.
  STANDOFF_DEVICE void follow(std::uint32_t index, double from) {
    const MovingTriangle triangle = triangle_at(index);
    const double spacing = static_cast<double>(task_.target.field.spacing);
    for (double t = from; t < kEnd && verdict_ == DeviceVerdict::free;) {
      double until = collision::look_ahead(t, triangle.speed, spacing);
      if (!(until > t)) verdict_ = DeviceVerdict::undecided;  // there is no time between t and the next one
      until = min(until, kEnd);
      int waiting = 0;
      const auto use = [&](bool near, std::uint32_t of_target, const FlatBox&) {
        const std::uint32_t lanes = __ballot_sync(kWarp, near);
        if (near) shared_.of_target[waiting + __popc(lanes & lanes_below(lane_in_warp()))] = of_target;
        waiting += __popc(lanes);
        __syncwarp();
        if (waiting < 32) return true;
        waiting -= 32;
        advance(triangle, t, until, waiting, 32);
        return verdict_ == DeviceVerdict::free;
      };
      if (!for_overlapping_boxes(swept_box(triangle, t, until), task_.target, shared_.target_nodes, task_.stack, use))
        verdict_ = DeviceVerdict::overflow;
      if (waiting > 0 && verdict_ == DeviceVerdict::free) advance(triangle, t, until, 0, waiting);
      t = until;
      if (t < kEnd) t = moved_triangle(index, t);
    }
  }

  STANDOFF_DEVICE FlatBox swept_box(const MovingTriangle& triangle, double t, double until) const {
    float low[3], high[3];
    collision::swept_bounds(query_.motion, triangle, t, until, query_.keep * 2, low, high);
    return {{low[0], low[1], low[2], high[0], high[1], high[2]}};
  }

  // The time until which the field shows the triangle's sphere to be free.
  STANDOFF_DEVICE double moved_triangle(std::uint32_t index, double start) const {
    const collision::Sphere16& spheres = task_.probe.spheres[0][index / kLanes];
    const std::uint32_t n = index % kLanes;
    return moved({spheres.center[0][n], spheres.center[1][n], spheres.center[2][n]}, spheres.radius[n], start, 0);
  }

  // Advances the triangle against `count` of the waiting target triangles, from `first` on.
  STANDOFF_DEVICE void advance(const MovingTriangle& triangle, double t, double until, int first, int count) {
    const int lane = static_cast<int>(lane_in_warp());
    const bool near = lane < count && comes_near(shared_.of_target[first + lane], triangle, t, until);
    if (__ballot_sync(kWarp, near) != 0) verdict_ = DeviceVerdict::undecided;
    // Order memory, which votes do not: other lanes write the next triangles over these.
    __syncwarp();
  }

  // Whether the triangle may come nearer to a target triangle than twice the distance to be kept, before `until`.
  STANDOFF_DEVICE bool comes_near(std::uint32_t of_target, const MovingTriangle& triangle, double t,
                                  double until) const {
    const double keep = static_cast<double>(query_.keep);
    Triple<double> p[3], q[3];
    load_corners(task_.target, of_target, p);
    for (Triple<double>& corner : p) corner = corner - task_.target.middle;
    while (t < until) {
      for (int k = 0; k < 3; ++k) q[k] = query_.motion.at(triangle.offset[k], t);
      // At the start they may cross: then the distance of edges and corners means nothing.
      if (t == 0) {
        const TriangleOverlap<double> overlap = triangle_overlap(p, q);
        if (overlap.intersecting || overlap.unsure) return true;
      }
      const PairPoints<double> pair = closest_pair(p, q);
      const double apart = sqrt(pair.distance_sq);
      if (!(apart > 2 * keep)) return true;
      const double nearing = approach(pair.separation * (1 / apart), triangle);
      if (!(nearing > 0)) return false;
      const double later = t + (apart - keep) / nearing;
      if (!(later > t)) return true;
      t = later;
    }
    return false;
  }

  // An upper bound of the speed at which corners of the triangle move against the unit vector n.
  STANDOFF_DEVICE double approach(const Triple<double>& n, const MovingTriangle& triangle) const {
    const collision::RelativeMotion& motion = query_.motion;
    if (motion.angle_rad == 0)
      return motion.target_moves ? plain_dot(n, motion.velocity) : -plain_dot(n, motion.velocity);
    if (motion.target_moves) return triangle.speed;
    return collision::rotation_speed_along(n, motion.axis, abs(motion.angle_rad), triangle.radius) -
           plain_dot(n, motion.velocity);
  }

  const SweepTask& task_;
  const SweepQuery& query_;
  SweepShared& shared_;
  DeviceVerdict verdict_ = DeviceVerdict::free;  // the same in all lanes
};

/// Warps take one motion after another.
__global__ void __launch_bounds__(kSweepThreads) advance_motions(SweepTask task) {
  __shared__ SweepShared shared[kSweepThreads / 32];
  answer_queries<MotionSearch>(task, shared);
}

inline void run_sweep(const collision::SweepJob& job, Backend backend) {
  const auto target = device_body_of(job.target, backend, job.device),
             probe = device_body_of(job.probe, backend, job.device);
  run_queries<kSweepThreads>(
      "advance_motions", advance_motions, job.queries, job.answers,
      [&](const SweepQuery* queries, SweepAnswer* answers, std::uint32_t count, std::uint32_t* next) {
        return SweepTask{target->view(), probe->view(), queries, answers, count, next, job.stack};
      });
}

}  // namespace standoff::STANDOFF_PLATFORM
