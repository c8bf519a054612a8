// Yes or no for many poses: a warp per pose. The tree's balls are looked up in the field, two packets of sixteen at a
// time, the nearest first. A packet of triangles that reaches the surface goes through the boxes of the field's tree;
// pairs whose boxes meet wait until there is one for each lane, and are decided in double precision. The bounds and the
// decision are the CPU's own (ball_bound.h, meeting.h), and so is the slack between single and double.
#pragma once

#include "collision/body/ball_bound.h"
#include "collision/cuda/field_boxes.cuh"
#include "collision/cuda/queries.cuh"
#include "geometry/triangle_overlap.h"

namespace standoff::STANDOFF_PLATFORM {

using collision::DeviceVerdict;
using collision::PoseAnswer;
using collision::PoseQuery;

inline constexpr unsigned kCollideThreads = 128;

struct CollideTask {
  BodyView field, tree;
  bool field_is_b;
  collision::DoublePlace of_a;
  double margin;
  const PoseQuery* queries;
  PoseAnswer* answers;
  std::uint32_t count;
  std::uint32_t* next;  ///< the first query that nobody has taken
  int stack;
};

/// A warp's part of shared memory.
struct SearchRoom {
  static constexpr int kWaiting = 64;  // 31 and what 32 lanes add
  std::uint32_t nodes[collision::kDeviceStack], field_nodes[collision::kDeviceStack];
  float gap[32];
  FlatBox box[kLanes], all;  // of the placed triangles
  std::uint32_t of_field[kWaiting], of_tree[kWaiting];
};

class PoseSearch {
  using Nodes = NodeStack<std::uint32_t>;

 public:
  STANDOFF_DEVICE PoseSearch(const CollideTask& task, const PoseQuery& query, SearchRoom& room)
      : task_(task), query_(query), room_(room), lane_(lane_in_warp()) {}

  STANDOFF_DEVICE PoseAnswer run() {
    Nodes nodes(room_.nodes, task_.stack, packet_word(task_.tree.top, 0));
    while (!nodes.empty() && verdict_ != DeviceVerdict::hit && verdict_ != DeviceVerdict::overflow) {
      // Where undecided a pair that surely touches may still come.
      const bool triangles = nodes.top_level() == 0;
      const std::uint32_t word = nodes.take(triangles ? kMostLevels : 1, kNoPacket);
      if (triangles)
        meet_packet(packet_of(__shfl_sync(kWarp, word, 0)));
      else
        open(nodes, word);
    }
    return {verdict_, of_field_, of_tree_};
  }

 private:
  STANDOFF_DEVICE float placed(int axis, float x, float y, float z) const {
    return collision::placed(query_.place, axis, x, y, z);
  }

  // Puts the packets below the nodes whose balls come near on the stack, the nearest on top.
  STANDOFF_DEVICE void open(Nodes& nodes, std::uint32_t word) {
    const int level = level_of(word), n = static_cast<int>(lane_ % kLanes);
    float gap = collision::kNothing;
    if (word != kNoPacket) {
      const collision::Balls& balls = task_.tree.balls[level][packet_of(word)];
      const float x = balls.center[0][n], y = balls.center[1][n], z = balls.center[2][n];
      gap = collision::gap_of_ball(task_.field.field, placed(0, x, y, z), placed(1, x, y, z), placed(2, x, y, z),
                                   balls.radius[n], query_.limit);
    }
    const bool near = gap <= query_.limit;
    const std::uint32_t lanes = __ballot_sync(kWarp, near);
    const int farther = larger_keys(lanes, gap, room_.gap);
    if (!nodes.put(lanes, farther, packet_word(level - 1, packet_of(word) * kLanes + n)))
      verdict_ = DeviceVerdict::overflow;
  }

  // The packet's triangles against those of the field's body.
  STANDOFF_DEVICE void meet_packet(std::uint32_t packet) {
    place_boxes(packet);
    int waiting = 0;
    const auto use = [&](bool near, std::uint32_t place, const FlatBox& box) {
      for (int t = 0; t < kLanes; ++t) {
        const bool meets = near && meet(box, room_.box[t]);
        const std::uint32_t lanes = __ballot_sync(kWarp, meets);
        if (lanes == 0) continue;
        if (meets) {
          const int at = waiting + __popc(lanes & lanes_below(lane_));
          room_.of_field[at] = place, room_.of_tree[at] = packet * kLanes + static_cast<std::uint32_t>(t);
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
    if (!for_boxes_that_meet(room_.all, task_.field, room_.field_nodes, task_.stack, use))
      verdict_ = DeviceVerdict::overflow;
    else if (waiting > 0 && verdict_ != DeviceVerdict::hit)
      settle(0, waiting);
  }

  // The boxes of a packet's triangles in the field's frame, grown by the limit, and the box around them.
  STANDOFF_DEVICE void place_boxes(std::uint32_t packet) {
    const collision::Faces& faces = task_.tree.faces[packet];
    if (lane_ < kLanes) {
      const bool exists = packet * kLanes + lane_ < task_.tree.triangles;
      for (int axis = 0; axis < 3; ++axis) {
        float low = collision::kNothing, high = -collision::kNothing;
        for (int k = 0; k < 3 && exists; ++k) {
          const float(&corner)[3][kLanes] = faces.corner[k];
          const float at = placed(axis, corner[0][lane_], corner[1][lane_], corner[2][lane_]);
          low = min(at, low), high = max(at, high);
        }
        room_.box[lane_].side[axis] = low - query_.limit, room_.box[lane_].side[3 + axis] = high + query_.limit;
      }
    }
    __syncwarp();
    if (lane_ < 6) {
      float side = room_.box[0].side[lane_];
      for (int n = 1; n < kLanes; ++n)
        side = lane_ < 3 ? min(side, room_.box[n].side[lane_]) : max(side, room_.box[n].side[lane_]);
      room_.all.side[lane_] = side;
    }
    __syncwarp();
  }

  // Decides `count` of the pairs that wait, from `first` on, a lane each.
  STANDOFF_DEVICE void settle(int first, int count) {
    bool touches = false, unsure = false;
    std::uint32_t of_field = 0, of_tree = 0;
    if (static_cast<int>(lane_) < count) {
      of_field = room_.of_field[first + lane_], of_tree = room_.of_tree[first + lane_];
      Triple<double> p[3], q[3];
      load_corners(task_.field, of_field, p);
      load_corners(task_.tree, of_tree, q);
      const collision::DoublePlace& of_p = task_.field_is_b ? query_.of_b : task_.of_a;
      const collision::DoublePlace& of_q = task_.field_is_b ? task_.of_a : query_.of_b;
      for (int k = 0; k < 3; ++k) p[k] = collision::placed(of_p, p[k]), q[k] = collision::placed(of_q, q[k]);
      const collision::Meeting<double> met = collision::meeting(p, q);
      touches = met.touch, unsure = met.unsure;
      if (!touches && task_.margin > 0)
        touches = collision::closest_pair(p, q).distance_sq <= task_.margin * task_.margin;
    }
    const std::uint32_t touching = __ballot_sync(kWarp, touches);
    if (touching != 0) {
      const int one = __ffs(static_cast<int>(touching)) - 1;
      of_field_ = __shfl_sync(kWarp, of_field, one), of_tree_ = __shfl_sync(kWarp, of_tree, one);
      verdict_ = DeviceVerdict::hit;
    } else if (__ballot_sync(kWarp, unsure) != 0) {
      verdict_ = DeviceVerdict::undecided;
    }
    // Other lanes write the next pairs where these were read: votes order no memory, this does.
    __syncwarp();
  }

  const CollideTask& task_;
  const PoseQuery& query_;
  SearchRoom& room_;
  const std::uint32_t lane_;
  // The same in all lanes.
  DeviceVerdict verdict_ = DeviceVerdict::free;
  std::uint32_t of_field_ = 0, of_tree_ = 0;
};

/// Warps take one pose after the other.
__global__ void __launch_bounds__(kCollideThreads) collide_poses(CollideTask task) {
  __shared__ SearchRoom rooms[kCollideThreads / 32];
  answer_queries<PoseSearch>(task, rooms);
}

/// Decides a batch on the current device.
inline void run_collide(const collision::CollideJob& job, Backend backend) {
  const auto field = on_device(job.field, backend, job.device), tree = on_device(job.tree, backend, job.device);
  run_queries<kCollideThreads>(
      "collide_poses", collide_poses, job.queries, job.answers,
      [&](const PoseQuery* queries, PoseAnswer* answers, std::uint32_t count, std::uint32_t* next) {
        return CollideTask{field->view(), tree->view(), job.field_is_b, job.of_a, job.margin,
                           queries,       answers,      count,          next,     job.stack};
      });
}

}  // namespace standoff::STANDOFF_PLATFORM
