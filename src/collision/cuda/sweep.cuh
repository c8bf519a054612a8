// Which moving bodies are certainly free? A warp per motion: the tree's balls move along until the field no longer
// tells them free, two packets of sixteen at a time, the first to stop first; their children start from there.
// Triangles that stop are followed against those that their way may meet, a lane each; where one comes nearer than
// twice the distance to be kept, the motion is undecided. Bounds and steps are the CPU's (way.h, sweep.cpp), but in the
// field's frame, for whose rounding the distance kept has room.
#pragma once

#include "collision/body/ball_bound.h"
#include "collision/cuda/field_boxes.cuh"
#include "collision/cuda/queries.cuh"
#include "geometry/triangle_overlap.h"

namespace standoff::STANDOFF_PLATFORM {

using collision::DeviceVerdict;
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
  static constexpr int kWaiting = 64;  // 31 and what 32 lanes add
  TimedPacket nodes[collision::kDeviceStack];
  std::uint32_t field_nodes[collision::kDeviceStack];
  double time[32];
  std::uint32_t of_field[kWaiting];
};

/// A triangle of the tree's body on its way: its corners' offsets, and what bounds their way.
struct MovingTriangle {
  Triple<double> offset[3];
  double away, speed, acceleration;  ///< the most of the corners'
};

class MotionSearch {
 public:
  STANDOFF_DEVICE MotionSearch(const SweepTask& task, const SweepQuery& query, SweepRoom& room)
      : task_(task), query_(query), room_(room) {}

  STANDOFF_DEVICE SweepAnswer run() {
    NodeStack<TimedPacket> nodes(room_.nodes, task_.stack, {0, packet_word(task_.tree.top, 0)});
    while (!nodes.empty() && verdict_ == DeviceVerdict::free) {
      const TimedPacket packet = nodes.take(0, {0, kNoPacket});
      const int level = level_of(packet.word);
      const std::uint32_t n = lane_in_warp() % kLanes;
      double time = 2;
      if (packet.word != kNoPacket) {
        const collision::Balls& balls = task_.tree.balls[level][packet_of(packet.word)];
        if (balls.radius[n] >= 0)
          time =
              moved({balls.center[0][n], balls.center[1][n], balls.center[2][n]}, balls.radius[n], packet.time, level);
      }
      const std::uint32_t child = packet_of(packet.word) * kLanes + n;
      follow_all(level == 0 && time < kEnd, child, time);
      const bool inner = level > 0 && time < kEnd;
      const std::uint32_t lanes = __ballot_sync(kWarp, inner);
      const int later = larger_keys(lanes, time, room_.time);
      if (!nodes.put(lanes, later, {time, packet_word(level - 1, child)})) verdict_ = DeviceVerdict::overflow;
    }
    return {verdict_};
  }

 private:
  static constexpr double kEnd = 1;

  // Until when a ball is free that is so until `start`, or somewhat less.
  STANDOFF_DEVICE double moved(const Triple<double>& center, float radius, double start, int level) const {
    const collision::FieldView& field = task_.field.field;
    const float least = level == 0 ? collision::kWorthATrianglesStep * field.spacing : 0;
    const Triple<double> offset = query_.way.offset(center);
    collision::MovingBall ball{offset, query_.way.speed(offset), start, radius};
    for (bool goes_on = true; goes_on;) {
      const Triple<double> x = query_.way.at(offset, ball.time);
      const float gap = collision::gap_of_ball(field, static_cast<float>(x.x), static_cast<float>(x.y),
                                               static_cast<float>(x.z), radius, field.spacing);
      goes_on = ball.step(gap, query_.keep, kEnd, least);
    }
    return ball.time;
  }

  // Follows the triangles of those lanes that stopped.
  STANDOFF_DEVICE void follow_all(bool stopped, std::uint32_t place, double time) {
    for (std::uint32_t left = __ballot_sync(kWarp, stopped); left != 0 && verdict_ == DeviceVerdict::free;
         left &= left - 1) {
      const int lane = __ffs(static_cast<int>(left)) - 1;
      follow(__shfl_sync(kWarp, place, lane), __shfl_sync(kWarp, time, lane));
    }
  }

  STANDOFF_DEVICE MovingTriangle triangle_at(std::uint32_t place) const {
    MovingTriangle t{};
    load_corners(task_.tree, place, t.offset);
    for (Triple<double>& offset : t.offset) {
      offset = query_.way.offset(offset - task_.tree.middle);
      t.away = max(t.away, collision::length(offset));
      t.speed = max(t.speed, query_.way.speed(offset));
      t.acceleration = max(t.acceleration, query_.way.acceleration(offset));
    }
    return t;
  }

  // One triangle from a time on at which it is free, but at 0.
  STANDOFF_DEVICE void follow(std::uint32_t place, double from) {
    const MovingTriangle triangle = triangle_at(place);
    const double ahead = collision::kAhead * static_cast<double>(task_.field.field.spacing);
    for (double t = from; t < kEnd && verdict_ == DeviceVerdict::free;) {
      double until = triangle.speed > 0 ? t + ahead / triangle.speed : kEnd;
      if (!(until > t)) verdict_ = DeviceVerdict::undecided;  // there is no time between t and the next one
      until = min(until, kEnd);
      int waiting = 0;
      const auto use = [&](bool near, std::uint32_t of_field, const FlatBox&) {
        const std::uint32_t lanes = __ballot_sync(kWarp, near);
        if (near) room_.of_field[waiting + __popc(lanes & lanes_below(lane_in_warp()))] = of_field;
        waiting += __popc(lanes);
        __syncwarp();
        if (waiting < 32) return true;
        waiting -= 32;
        advance(triangle, t, until, waiting, 32);
        return verdict_ == DeviceVerdict::free;
      };
      if (!for_boxes_that_meet(box_of_way(triangle, t, until), task_.field, room_.field_nodes, task_.stack, use))
        verdict_ = DeviceVerdict::overflow;
      if (waiting > 0 && verdict_ == DeviceVerdict::free) advance(triangle, t, until, 0, waiting);
      t = until;
      if (t < kEnd) t = moved_triangle(place, t);
    }
  }

  // A way between two times leaves the chord by an eighth of the acceleration times the time squared at the most.
  STANDOFF_DEVICE FlatBox box_of_way(const MovingTriangle& triangle, double t, double until) const {
    const double bend = triangle.acceleration * (until - t) * (until - t) / 8;
    const float by = query_.keep * 2 + static_cast<float>(bend) * 1.000001f;
    float low[3], high[3];
    for (int axis = 0; axis < 3; ++axis) low[axis] = collision::kNothing, high[axis] = -collision::kNothing;
    for (int k = 0; k < 6; ++k) {
      const Triple<double> x = query_.way.at(triangle.offset[k % 3], k < 3 ? t : until);
      const float at[3] = {static_cast<float>(x.x), static_cast<float>(x.y), static_cast<float>(x.z)};
      for (int axis = 0; axis < 3; ++axis) low[axis] = min(at[axis], low[axis]), high[axis] = max(at[axis], high[axis]);
    }
    return {{low[0] - by, low[1] - by, low[2] - by, high[0] + by, high[1] + by, high[2] + by}};
  }

  // As far as the field lets the triangle's ball go.
  STANDOFF_DEVICE double moved_triangle(std::uint32_t place, double start) const {
    const collision::Balls& balls = task_.tree.balls[0][place / kLanes];
    const std::uint32_t n = place % kLanes;
    return moved({balls.center[0][n], balls.center[1][n], balls.center[2][n]}, balls.radius[n], start, 0);
  }

  // The triangle against `count` of those that wait, from `first` on.
  STANDOFF_DEVICE void advance(const MovingTriangle& triangle, double t, double until, int first, int count) {
    const int lane = static_cast<int>(lane_in_warp());
    const bool near = lane < count && comes_near(room_.of_field[first + lane], triangle, t, until);
    if (__ballot_sync(kWarp, near) != 0) verdict_ = DeviceVerdict::undecided;
    // Other lanes write the next triangles where these were read: votes order no memory, this does.
    __syncwarp();
  }

  // Whether the triangle may come nearer to one of the field's than twice the distance to be kept, before `until`.
  STANDOFF_DEVICE bool comes_near(std::uint32_t of_field, const MovingTriangle& triangle, double t,
                                  double until) const {
    const double keep = static_cast<double>(query_.keep);
    Triple<double> p[3], q[3];
    load_corners(task_.field, of_field, p);
    for (Triple<double>& corner : p) corner = corner - task_.field.middle;
    while (t < until) {
      for (int k = 0; k < 3; ++k) q[k] = query_.way.at(triangle.offset[k], t);
      // At the start they may cross, where the distance of edges and corners says nothing.
      if (t == 0) {
        const collision::Meeting<double> met = collision::meeting(p, q);
        if (met.touch || met.unsure) return true;
      }
      const collision::PairPoints<double> pair = collision::closest_pair(p, q);
      const double apart = sqrt(pair.distance_sq);
      if (!(apart > 2 * keep)) return true;
      const double nearing = approach(pair.way * (1 / apart), triangle);
      if (!(nearing > 0)) return false;
      const double later = t + (apart - keep) / nearing;
      if (!(later > t)) return true;
      t = later;
    }
    return false;
  }

  // No corner of the triangle moves against the unit vector n faster than this.
  STANDOFF_DEVICE double approach(const Triple<double>& n, const MovingTriangle& triangle) const {
    const collision::Way& way = query_.way;
    if (way.angle_rad == 0)
      return way.field_moves ? collision::plain_dot(n, way.velocity) : -collision::plain_dot(n, way.velocity);
    if (way.field_moves) return triangle.speed;
    const double turning = collision::length(collision::plain_cross(n, way.axis)) * abs(way.angle_rad);
    return turning * triangle.away - collision::plain_dot(n, way.velocity);
  }

  const SweepTask& task_;
  const SweepQuery& query_;
  SweepRoom& room_;
  DeviceVerdict verdict_ = DeviceVerdict::free;  // the same in all lanes
};

/// Warps take one motion after the other.
__global__ void __launch_bounds__(kSweepThreads) advance_motions(SweepTask task) {
  __shared__ SweepRoom rooms[kSweepThreads / 32];
  answer_queries<MotionSearch>(task, rooms);
}

inline void run_sweep(const collision::SweepJob& job, Backend backend) {
  const auto field = on_device(job.field, backend, job.device), tree = on_device(job.tree, backend, job.device);
  run_queries<kSweepThreads>(
      "advance_motions", advance_motions, job.queries, job.answers,
      [&](const SweepQuery* queries, SweepAnswer* answers, std::uint32_t count, std::uint32_t* next) {
        return SweepTask{field->view(), tree->view(), queries, answers, count, next, job.stack};
      });
}

}  // namespace standoff::STANDOFF_PLATFORM
