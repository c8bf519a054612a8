// Until when are moving bodies certainly apart? A warp per motion: the tree's balls move along until the field no
// longer tells them free, two packets of sixteen at a time, the first to stop first; their children start from there.
// The least time at which a triangle's ball is stopped is the answer. The steps are the CPU's (way.h).
#pragma once

#include "collision/ball_bound.h"
#include "cuda/queries.cuh"

namespace difi::DIFI_PLATFORM {

using collision::SweepAnswer;
using collision::SweepQuery;

inline constexpr unsigned kSweepThreads = 128;

struct SweepTask {
  BodyView field, tree;
  const SweepQuery* queries;
  SweepAnswer* answers;
  std::uint32_t count;
  std::uint32_t* next;  ///< the first query that nobody has taken
  int stack;
};

/// A warp's part of shared memory.
struct SweepRoom {
  TimedPacket nodes[collision::kDeviceStack];
  double time[32];
};

/// The least of the warp's values, in all lanes.
DIFI_DEVICE double least_in_warp(double value) {
  for (int bits = 16; bits > 0; bits /= 2) value = min(value, __shfl_xor_sync(kWarp, value, bits));
  return value;
}

class MotionSearch {
 public:
  DIFI_DEVICE MotionSearch(const SweepTask& task, const SweepQuery& query, SweepRoom& room)
      : task_(task), query_(query), room_(room) {}

  DIFI_DEVICE SweepAnswer run() {
    NodeStack<TimedPacket> nodes(room_.nodes, task_.stack, {0, packet_word(task_.tree.top, 0)});
    while (!nodes.empty()) {
      const TimedPacket packet = nodes.take(0, {0, kNoPacket});
      const int level = level_of(packet.word);
      const std::uint32_t n = lane_in_warp() % kLanes;
      double time = 2;
      if (packet.word != kNoPacket && packet.time < end_) {
        const collision::Balls& balls = task_.tree.balls[level][packet_of(packet.word)];
        if (balls.radius[n] >= 0)
          time =
              moved({balls.center[0][n], balls.center[1][n], balls.center[2][n]}, balls.radius[n], packet.time, level);
      }
      end_ = min(end_, least_in_warp(level == 0 ? time : 2));
      const bool inner = level > 0 && time < end_;
      const std::uint32_t lanes = __ballot_sync(kWarp, inner);
      const int later = larger_keys(lanes, time, room_.time);
      if (!nodes.put(lanes, later, {time, packet_word(level - 1, packet_of(packet.word) * kLanes + n)}))
        return {collision::Verdict::overflow, 0};
    }
    return {end_ < 1 ? collision::Verdict::undecided : collision::Verdict::free, end_};
  }

 private:
  // Until when a ball is free that is so until `start`, or somewhat less.
  DIFI_DEVICE double moved(const Triple<double>& center, float radius, double start, int level) const {
    const collision::FieldView& field = task_.field.field;
    const float least = level == 0 ? collision::kWorthATrianglesStep * field.spacing : 0;
    const Triple<double> offset = query_.way.offset(center);
    collision::MovingBall ball{offset, query_.way.speed(offset), start, radius};
    for (bool goes_on = true; goes_on;) {
      const Triple<double> x = query_.way.at(offset, ball.time);
      const float gap = collision::gap_of_ball(field, static_cast<float>(x.x), static_cast<float>(x.y),
                                               static_cast<float>(x.z), radius, field.spacing);
      goes_on = ball.step(gap, query_.keep, end_, least);
    }
    return ball.time;
  }

  const SweepTask& task_;
  const SweepQuery& query_;
  SweepRoom& room_;
  double end_ = 1;  // nothing later is of interest; the same in all lanes
};

/// Warps take one motion after the other.
__global__ void __launch_bounds__(kSweepThreads) advance_motions(SweepTask task) {
  __shared__ SweepRoom rooms[kSweepThreads / 32];
  SweepRoom& room = rooms[threadIdx.x / 32];
  for (;;) {
    const std::uint32_t n = take_query(task.next);
    if (n >= task.count) return;
    const SweepAnswer answer = MotionSearch(task, task.queries[n], room).run();
    if (lane_in_warp() == 0) task.answers[n] = answer;
  }
}

inline void run_sweep(const collision::SweepJob& job, Backend backend) {
  const auto field = on_device(job.field, backend, job.device), tree = on_device(job.tree, backend, job.device);
  run_queries<kSweepThreads>(
      "advance_motions", advance_motions, job.queries, job.answers,
      [&](const SweepQuery* queries, SweepAnswer* answers, std::uint32_t count, std::uint32_t* next) {
        return SweepTask{field->view(), tree->view(), queries, answers, count, next, job.stack};
      });
}

}  // namespace difi::DIFI_PLATFORM
