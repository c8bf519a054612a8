// SPDX-License-Identifier: Apache-2.0
// The nearest pair of triangles for many poses. A warp descends both bodies' hierarchies of oriented boxes, two pairs
// of nodes at a time, the nearest first. Two leaves that are near are compared along six axes, and the pairs of
// triangles that are left are measured in double precision, one per lane. What the bounds drop cannot be as near as the
// best pair (near_bounds.h, tolerances.h, which the CPU shares), so the first of the nearest pairs is found in any
// order.
//
// Many warps may search for one pose: a warp that has opened many pairs of nodes hands over what waits on its stack.
// The host starts the kernel again until nothing waits. All warps of a pose lower one distance by an atomic minimum.
#pragma once

#include <algorithm>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "collision/body/box_distance.h"
#include "collision/cuda/queries.cuh"
#include "collision/near_bounds.h"
#include "geometry/triangle_overlap.h"
#include "gpu/warp.cuh"
#include "standoff/collision.h"

namespace standoff::STANDOFF_PLATFORM {

using collision::DeviceVerdict;
using collision::DistanceQuery;
using collision::LeafAxes;
using collision::Obb;
using collision::PerpendicularAxes;

inline constexpr unsigned kDistanceThreads = 128;

/// Where so many pairs are about as near as the best one, the CPU asks for a proof that none is nearer.
inline constexpr std::uint32_t kManyTies = 1u << 20;

/// A node of the target and one of the probe, as packet words, and a lower bound of their distance.
struct NodesApart {
  float distance_sq;
  std::uint32_t node[2];
};
/// Level 0: two leaves.
STANDOFF_DEVICE std::uint32_t word_of(const NodesApart& pair) {
  return packet_word(level_of(pair.node[0]) + level_of(pair.node[1]), 0);
}

/// A pair of nodes that another warp looks at.
struct HandedNodes {
  NodesApart nodes;
  std::uint32_t pose;
};

/// What the warps of a pose share.
struct PoseState {
  unsigned long long least_sq;  ///< the bits of the least squared distance so far; at first the limit's
  std::uint32_t stopped;        ///< the bits of a DeviceVerdict; not free: the search has ended
  std::uint32_t ties;           ///< pairs about as near
  std::uint32_t node_pairs, measured;
};

/// A pair of triangles that may be the nearest of a pose.
struct FoundPair {
  double distance_sq;
  std::uint32_t pose, of_target, of_probe, unused;
};

struct DistanceTask {
  DeviceBodyView body[2];  ///< target and probe
  bool target_is_b, probe_is_small;
  DoubleTransform of_a;
  double radii;     ///< of both bodies together
  double limit_sq;  ///< pairs as far apart are not found
  const DistanceQuery* queries;
  PoseState* states;
  const HandedNodes* items;  ///< null: the roots, for each pose
  std::uint32_t count;
  std::uint32_t* next;  ///< the first item that no warp has taken
  HandedNodes* handed;
  FoundPair* found;
  std::uint32_t *handed_count, *found_count;  ///< may exceed the room
  std::uint32_t handed_room, found_room;
  int stack, turn;
};

/// A warp's part of shared memory.
struct NearestShared {
  static constexpr int kWaiting = 64;  // 31 pairs, and 32 that the lanes add
  NodesApart nodes[collision::kDeviceStack];
  float distance_sq[32];
  float low[2][3][32], high[2][3][32];  // of the triangles of two leaves, along two sets of axes
  float bound_sq[kWaiting];
  std::uint32_t of_target[kWaiting], of_probe[kWaiting];
  PerpendicularAxes axes;  // about the line between the nearest points
  LeafAxes node_axes;      // the same for both bodies
};

class NearestPairs {
  using Nodes = NodeStack<NodesApart>;

 public:
  STANDOFF_DEVICE NearestPairs(const DistanceTask& task, std::uint32_t pose, NearestShared& shared)
      : task_(task),
        query_(task.queries[pose]),
        state_(task.states[pose]),
        shared_(shared),
        lane_(lane_in_warp()),
        pose_(pose),
        slack_(collision::kNodePairSlack * task.radii + query_.pose_slack),
        own_sq_(task.limit_sq) {}

  STANDOFF_DEVICE void run(const NodesApart& first) {
    Nodes nodes(shared_.nodes, task_.stack, first);
    for (int turns = 0; !nodes.empty() && follow_others();) {
      if (turns++ == task_.turn) {
        hand_over(nodes);
        turns = 0;
      } else if (nodes.top_level() == 0) {
        look_at(nodes.take(kNever, none()));
      } else {
        open(nodes, nodes.take(1, none()));
      }
    }
    if (verdict_ == DeviceVerdict::free) measure(0, waiting_);
    tell_others();
  }

 private:
  static constexpr int kNever = 99;  // no entry has such a level: one is taken
  STANDOFF_DEVICE static NodesApart none() { return {collision::kInfinity, {kNoPacket, kNoPacket}}; }

  // Takes over the best distance of all warps; false if the search has ended.
  STANDOFF_DEVICE bool follow_others() {
    unsigned long long least = 0;
    std::uint32_t stopped = 0;
    if (lane_ == 0) {
      least = load_relaxed(&state_.least_sq), stopped = load_relaxed(&state_.stopped);
      if (ties_ > kManyTies || load_relaxed(&state_.ties) > kManyTies)
        stopped |= static_cast<std::uint32_t>(DeviceVerdict::undecided);
    }
    verdict_ = static_cast<DeviceVerdict>(static_cast<std::uint32_t>(verdict_) | __shfl_sync(kWarp, stopped, 0));
    least = __shfl_sync(kWarp, least, 0);
    double least_sq;
    __builtin_memcpy(&least_sq, &least, sizeof least_sq);
    if (least_sq < best_sq_ || reach_sq_ < 0) lower_reach(least_sq);
    return verdict_ == DeviceVerdict::free;
  }

  STANDOFF_DEVICE void lower_reach(double distance_sq) {
    best_sq_ = distance_sq;
    const double best = sqrt(distance_sq), near = best + collision::kTies * collision::about_equal(best, slack_);
    near_sq_ = near * near;
    wanted_ = min(near * (1 + collision::kFarShare), kMaxMargin);
    reach_sq_ = collision::reach_sq(wanted_, slack_);
  }

  STANDOFF_DEVICE Obb box_of(int side, std::uint32_t word) const {
    const std::uint32_t number = packet_of(word);
    return task_.body[side].oriented[level_of(word) + 1][number / kLanes].lane(static_cast<int>(number % kLanes));
  }

  // Opens the larger node of each of two pairs, and pushes the children's pairs that are near, the nearest on top.
  STANDOFF_DEVICE void open(Nodes& nodes, const NodesApart& pair) {
    NodesApart child = pair;
    const bool opens = pair.node[0] != kNoPacket && pair.distance_sq <= reach_sq_;
    bool near = false;
    if (opens) {
      const Obb target = box_of(0, pair.node[0]), probe = box_of(1, pair.node[1]);
      const int side = collision::opens_target(level_of(pair.node[0]), target, level_of(pair.node[1]), probe) ? 0 : 1;
      const int level = level_of(pair.node[side]);
      const std::uint32_t number = packet_of(pair.node[side]), n = lane_ % kLanes;
      child.node[side] = packet_word(level - 1, number * kLanes + n);
      if (number * kLanes + n < task_.body[side].nodes_of(level - 1)) {
        child.distance_sq = max(pair.distance_sq, distance_sq_of(side, level, number, n, side == 0 ? probe : target));
        near = child.distance_sq <= reach_sq_;
      }
    }
    node_pairs_ += __popc(__ballot_sync(kWarp, opens)) / kLanes;
    const std::uint32_t lanes = __ballot_sync(kWarp, near);
    const int farther = larger_keys(lanes, child.distance_sq, shared_.distance_sq);
    if (nodes.put(lanes, farther, child)) return;
    hand_over(nodes);
    if (!nodes.put(lanes, farther, child)) verdict_ = DeviceVerdict::overflow;
  }

  // A lower bound of the squared distance of child n of a node of one side from a box of the other one.
  STANDOFF_DEVICE float distance_sq_of(int side, int level, std::uint32_t number, std::uint32_t n,
                                       const Obb& box) const {
    const Obb own = task_.body[side].oriented[level][number].lane(static_cast<int>(n));
    const collision::OrientedBoxes<float> child{{own.center[0], own.center[1], own.center[2]},
                                                {{own.axis[0][0], own.axis[0][1], own.axis[0][2]},
                                                 {own.axis[1][0], own.axis[1][1], own.axis[1][2]},
                                                 {own.axis[2][0], own.axis[2][1], own.axis[2][2]}},
                                                {own.half[0], own.half[1], own.half[2]}};
    const Obb other =
        side == 0 ? collision::in_target(query_.transform, box) : collision::in_probe(query_.transform, box);
    const float(*const axes)[3] = side == 0 ? shared_.node_axes.first : shared_.node_axes.second;
    const float by_boxes = collision::box_distance_sq(child, other, has_axes_ ? axes : nullptr);
    if (side == 0 || !task_.probe_is_small) return by_boxes;
    const collision::Sphere16& spheres = task_.body[1].spheres[level][number];
    const auto at = [&](int axis) {
      return collision::transformed(query_.transform, axis, spheres.center[0][n], spheres.center[1][n],
                                    spheres.center[2][n]);
    };
    const float gap =
        collision::gap_of_sphere(task_.body[0].field, at(0), at(1), at(2), spheres.radius[n], sqrt(reach_sq_));
    return gap > 0 ? max(by_boxes, gap * gap) : by_boxes;
  }

  // Compares the triangles of two leaves, one per lane, and lets those pairs wait that may be near. The pair is in the
  // first half of the warp.
  STANDOFF_DEVICE void look_at(NodesApart leaves) {
    leaves.distance_sq = __shfl_sync(kWarp, leaves.distance_sq, 0);
    if (leaves.distance_sq > reach_sq_) return;
    for (std::uint32_t& node : leaves.node) node = packet_of(__shfl_sync(kWarp, node, 0));
    ++node_pairs_;
    const Obb box[2] = {box_of(0, leaves.node[0]), box_of(1, leaves.node[1])};
    const double slack = collision::leaf_slack(task_.radii, box[0], box[1], query_.pose_slack);
    const Triple<double> offset = collision::offset_of(query_.to_target, box[0], box[1]);
    const int side = lane_ < kLanes ? 0 : 1;
    const std::uint32_t n = lane_ % kLanes, leaf = leaves.node[side];
    Triple<float> corner[3];
    for (int k = 0; k < 3; ++k) {
      const float(&at)[3][kLanes] = task_.body[side].triangles[leaf].corner[k];
      corner[k] = Triple<float>{at[0][n], at[1][n], at[2][n]} -
                  Triple<float>{box[side].center[0], box[side].center[1], box[side].center[2]};
    }
    const bool exists = leaf * kLanes + n < task_.body[side].triangle_count;
    const LeafAxes along_best = collision::leaf_axes(
        query_.to_target, has_axes_ ? shared_.axes : collision::perpendicular_axes(offset), offset);
    // Most triangles are too far apart along the first axis alone.
    const collision::Projection<float> first = projected(along_best, 0, side, corner);
    collision::Projection<float> others = first;
    for (int step = 1; step < kLanes; step *= 2) {
      others.low = min(others.low, __shfl_xor_sync(kWarp, others.low, step));
      others.high = max(others.high, __shfl_xor_sync(kWarp, others.high, step));
    }
    others = {__shfl_xor_sync(kWarp, others.low, kLanes), __shfl_xor_sync(kWarp, others.high, kLanes)};
    const bool near = exists && collision::squared_gap(first, others) <= most_sq(slack);
    const std::uint32_t lanes = __ballot_sync(kWarp, near), of_target = lanes & ((1u << kLanes) - 1);
    if (of_target == 0 || lanes >> kLanes == 0) return;
    const LeafAxes along_box = collision::leaf_axes(
        query_.to_target,
        {{collision::axis_of(box[0], 0), collision::axis_of(box[0], 1), collision::axis_of(box[0], 2)}}, offset);
    for (int k = 0; k < 3; ++k) {
      keep(0, k, k == 0 ? first : projected(along_best, k, side, corner));
      keep(1, k, projected(along_box, k, side, corner));
    }
    __syncwarp();
    pair_up(of_target, lanes >> kLanes, leaves, slack);
    __syncwarp();
  }

  STANDOFF_DEVICE static collision::Projection<float> projected(const LeafAxes& axes, int k, int side,
                                                                const Triple<float> (&corner)[3]) {
    collision::Projection<float> on = collision::projected(corner, side == 0 ? axes.first[k] : axes.second[k]);
    if (side == 1) on.low = on.low + axes.offset[k], on.high = on.high + axes.offset[k];
    return on;
  }
  STANDOFF_DEVICE void keep(int set, int k, const collision::Projection<float>& on) {
    shared_.low[set][k][lane_] = on.low, shared_.high[set][k][lane_] = on.high;
  }
  STANDOFF_DEVICE collision::Projection<float> kept(int set, int k, std::uint32_t lane) const {
    return {shared_.low[set][k][lane], shared_.high[set][k][lane]};
  }
  STANDOFF_DEVICE float most_sq(double slack) const { return min(collision::reach_sq(wanted_, slack), reach_sq_); }

  // Each half of the warp takes a triangle of the target's leaf, each lane one of the probe's.
  STANDOFF_DEVICE void pair_up(std::uint32_t of_target, std::uint32_t of_probe, const NodesApart& leaves,
                               double slack) {
    const std::uint32_t n = lane_ % kLanes;
    while (of_target != 0 && verdict_ == DeviceVerdict::free) {
      const int one = __ffs(static_cast<int>(of_target)) - 1;
      of_target &= of_target - 1;
      const int two = of_target == 0 ? -1 : __ffs(static_cast<int>(of_target)) - 1;
      of_target &= of_target - 1;
      const int row = lane_ < kLanes ? one : two;
      float bound_sq = collision::kInfinity;
      if (row >= 0 && (of_probe >> n & 1) != 0) {
        float of_set[2] = {};
        for (int set = 0; set < 2; ++set)
          for (int k = 0; k < 3; ++k)
            of_set[set] +=
                collision::squared_gap(kept(set, k, static_cast<std::uint32_t>(row)), kept(set, k, kLanes + n));
        bound_sq = max(of_set[0], of_set[1]);
      }
      const bool near = bound_sq <= most_sq(slack) && row >= 0 && (of_probe >> n & 1) != 0;
      const std::uint32_t lanes = __ballot_sync(kWarp, near);
      if (lanes == 0) continue;
      if (near) {
        const int at = waiting_ + __popc(lanes & lanes_below(lane_));
        shared_.bound_sq[at] = bound_sq;
        shared_.of_target[at] = leaves.node[0] * kLanes + static_cast<std::uint32_t>(row);
        shared_.of_probe[at] = leaves.node[1] * kLanes + n;
      }
      waiting_ += __popc(lanes);
      __syncwarp();
      if (waiting_ < 32 && best_sq_ < kUnknown) continue;
      const int count = waiting_ < 32 ? waiting_ : 32;
      waiting_ -= count;
      measure(waiting_, count);
    }
  }

  // Measures `count` of the waiting pairs, from `first` on, one per lane.
  STANDOFF_DEVICE void measure(int first, int count) {
    const bool takes = static_cast<int>(lane_) < count && shared_.bound_sq[first + lane_] <= reach_sq_;
    bool touching = false;
    double distance_sq = kUnknown;
    std::uint32_t of_target = 0, of_probe = 0;
    Triple<double> separation{};
    if (takes) {
      of_target = shared_.of_target[first + lane_], of_probe = shared_.of_probe[first + lane_];
      Triple<double> p[3], q[3];
      load_corners(task_.body[0], of_target, p);
      load_corners(task_.body[1], of_probe, q);
      const DoubleTransform& of_p = task_.target_is_b ? query_.of_b : task_.of_a;
      const DoubleTransform& of_q = task_.target_is_b ? task_.of_a : query_.of_b;
      for (int k = 0; k < 3; ++k) p[k] = standoff::transformed(of_p, p[k]), q[k] = standoff::transformed(of_q, q[k]);
      if (shared_.bound_sq[first + lane_] <= collision::reach_sq(0, slack_)) {
        const TriangleOverlap<double> overlap = triangle_overlap(p, q);
        touching = overlap.intersecting || overlap.unsure;
      }
      const PairPoints<double> pair = closest_pair(p, q);
      distance_sq = pair.distance_sq, separation = pair.separation;
    }
    // Order memory, which votes do not: other lanes write the next pairs over these.
    __syncwarp();
    measured_ += __popc(__ballot_sync(kWarp, takes));
    ties_ += __popc(__ballot_sync(kWarp, takes && distance_sq <= near_sq_));
    if (__ballot_sync(kWarp, touching) != 0)
      verdict_ = DeviceVerdict::undecided;
    else
      take_nearest(distance_sq, of_target, of_probe, separation);
  }

  // Of equally near pairs the first one counts: by its triangles, the target's before the probe's.
  STANDOFF_DEVICE void take_nearest(double distance_sq, std::uint32_t of_target, std::uint32_t of_probe,
                                    const Triple<double>& separation) {
    unsigned long long pair = static_cast<unsigned long long>(of_target) << 32 | of_probe;
    const bool nearer = distance_sq < own_sq_ || (distance_sq == own_sq_ && pair < own_pair_);
    if (__ballot_sync(kWarp, nearer && distance_sq <= best_sq_) == 0) return;
    double least_sq = distance_sq;
    for (int step = 16; step > 0; step /= 2) least_sq = min(least_sq, __shfl_xor_sync(kWarp, least_sq, step));
    if (distance_sq != least_sq) pair = kNoPair;
    unsigned long long least = pair;
    for (int step = 16; step > 0; step /= 2) {
      const unsigned long long other = __shfl_xor_sync(kWarp, least, step);
      least = other < least ? other : least;
    }
    own_sq_ = least_sq, own_pair_ = least, has_found_ = true;
    point_along(separation, __ffs(static_cast<int>(__ballot_sync(kWarp, pair == least))) - 1);
    if (!(least_sq < best_sq_)) return;
    unsigned long long bits;
    __builtin_memcpy(&bits, &least_sq, sizeof bits);
    if (lane_ == 0) atomicMin(&state_.least_sq, bits);
    lower_reach(least_sq);
  }

  // Bounds are taken along the line between the nearest points from now on. It is one lane's.
  STANDOFF_DEVICE void point_along(const Triple<double>& separation, int lane) {
    const Triple<double> line{__shfl_sync(kWarp, separation.x, lane), __shfl_sync(kWarp, separation.y, lane),
                              __shfl_sync(kWarp, separation.z, lane)};
    const DoubleTransform& of_p = task_.target_is_b ? query_.of_b : task_.of_a;
    const PerpendicularAxes axes = collision::perpendicular_axes(collision::rotated_back(of_p, line));
    __syncwarp();
    if (lane_ == 0) shared_.axes = axes, shared_.node_axes = collision::leaf_axes(query_.to_target, axes, {});
    __syncwarp();
    has_axes_ = true;
  }

  // Hands the stack, from its top, over to other warps, as far as there is room.
  STANDOFF_DEVICE void hand_over(Nodes& nodes) {
    std::uint32_t first = task_.handed_room;
    if (lane_ == 0 && load_relaxed(task_.handed_count) < task_.handed_room)
      first = atomicAdd(task_.handed_count, static_cast<std::uint32_t>(nodes.count()));
    first = __shfl_sync(kWarp, first, 0);
    if (first >= task_.handed_room) return;
    const auto room = static_cast<int>(task_.handed_room - first);
    const int count = nodes.count() < room ? nodes.count() : room;
    for (int n = static_cast<int>(lane_); n < count; n += 32) task_.handed[first + n] = {nodes.from_top(n), pose_};
    nodes.drop(count);
  }

  STANDOFF_DEVICE void tell_others() const {
    if (lane_ != 0) return;
    atomicAdd(&state_.node_pairs, node_pairs_);
    atomicAdd(&state_.measured, measured_);
    if (load_relaxed(&state_.ties) <= kManyTies) atomicAdd(&state_.ties, ties_ < 1u << 16 ? ties_ : 1u << 16);
    DeviceVerdict verdict = verdict_;
    if (has_found_ && own_sq_ <= best_sq_) {
      const std::uint32_t at = atomicAdd(task_.found_count, 1u);
      if (at < task_.found_room)
        task_.found[at] = {own_sq_, pose_, static_cast<std::uint32_t>(own_pair_ >> 32),
                           static_cast<std::uint32_t>(own_pair_), 0};
      else
        verdict = DeviceVerdict::overflow;
    }
    if (verdict != DeviceVerdict::free) atomicOr(&state_.stopped, static_cast<std::uint32_t>(verdict));
  }

  static constexpr unsigned long long kNoPair = ~0ull;
  static constexpr double kUnknown = collision::kInfinity;
  const DistanceTask& task_;
  const DistanceQuery& query_;
  PoseState& state_;
  NearestShared& shared_;
  const std::uint32_t lane_, pose_;
  const double slack_;  // of bounds of pairs of nodes
  // The same in all lanes.
  DeviceVerdict verdict_ = DeviceVerdict::free;
  bool has_axes_ = false;
  double best_sq_ = kUnknown, near_sq_ = 0, wanted_ = 0;  // of all warps
  float reach_sq_ = -1;
  // The nearest pair of this warp, the target's triangle in the high half; at first the limit, and the first of pairs.
  bool has_found_ = false;
  double own_sq_;
  unsigned long long own_pair_ = 0;
  int waiting_ = 0;
  std::uint32_t node_pairs_ = 0, measured_ = 0, ties_ = 0;
};

/// Warps take one item after another.
__global__ void __launch_bounds__(kDistanceThreads) find_nearest_pairs(DistanceTask task) {
  __shared__ NearestShared shared[kDistanceThreads / 32];
  for (;;) {
    const std::uint32_t n = take_query(task.next);
    if (n >= task.count) return;
    HandedNodes item{{0, {packet_word(task.body[0].top, 0), packet_word(task.body[1].top, 0)}}, n};
    if (task.items != nullptr) item = task.items[n];
    NearestPairs(task, item.pose, shared[threadIdx.x / 32]).run(item.nodes);
  }
}

/// Writes the answers: of the pairs found for each pose the nearest, and of equally near ones the first.
inline void gather_answers(std::span<const PoseState> states, std::span<const FoundPair> found,
                           std::span<collision::DistanceAnswer> answers) {
  std::vector<double> least_sq(answers.size(), std::numeric_limits<double>::infinity());
  for (std::size_t n = 0; n < answers.size(); ++n)
    answers[n] = {static_cast<DeviceVerdict>(states[n].stopped),
                  kNoTriangle,
                  kNoTriangle,
                  states[n].ties,
                  states[n].node_pairs,
                  states[n].measured};
  for (const FoundPair& pair : found) {
    collision::DistanceAnswer& answer = answers[pair.pose];
    double& least = least_sq[pair.pose];
    if (pair.distance_sq > least) continue;
    const bool precedes = std::pair(pair.of_target, pair.of_probe) < std::pair(answer.of_target, answer.of_probe);
    if (pair.distance_sq == least && !precedes) continue;
    least = pair.distance_sq, answer.of_target = pair.of_target, answer.of_probe = pair.of_probe;
  }
}

/// Answers a batch on the current device.
inline void run_distance(const collision::DistanceJob& job, Backend backend) {
  const auto target = device_body_of(job.target, backend, job.device),
             probe = device_body_of(job.probe, backend, job.device);
  const auto bytes_of = []<class T>(std::span<T> values) { return static_cast<std::int64_t>(values.size_bytes()); };
  const double limit_sq = job.limit * job.limit;
  PoseState first{};
  __builtin_memcpy(&first.least_sq, &limit_sq, sizeof limit_sq);
  std::vector<PoseState> states(job.queries.size(), first);
  const std::uint32_t found_room = static_cast<std::uint32_t>(states.size()) + job.lists.found;
  const std::int64_t handed_bytes = std::int64_t{job.lists.handed} * std::int64_t{sizeof(HandedNodes)};
  enum Counter { next, handed, found_pairs, counters };
  const Memory of_queries(bytes_of(job.queries)), of_states(bytes_of(std::span(states))),
      of_found(std::int64_t{found_room} * std::int64_t{sizeof(FoundPair)}), of_counters(counters * 4),
      lists[2] = {Memory(handed_bytes), Memory(handed_bytes)};
  copy_in(of_queries.as<void>(), job.queries.data(), bytes_of(job.queries));
  copy_in(of_states.as<void>(), states.data(), bytes_of(std::span(states)));
  std::uint32_t* const counter = of_counters.as<std::uint32_t>();
  std::uint32_t counts[counters] = {};
  copy_in(counter, counts, sizeof counts);
  DistanceTask task{.body = {target->view(), probe->view()},
                    .target_is_b = job.target_is_b,
                    .probe_is_small = job.probe_is_small,
                    .of_a = job.of_a,
                    .radii = job.target.radius + job.probe.radius,
                    .limit_sq = limit_sq,
                    .queries = of_queries.as<DistanceQuery>(),
                    .states = of_states.as<PoseState>(),
                    .items = nullptr,
                    .count = static_cast<std::uint32_t>(states.size()),
                    .next = counter + next,
                    .handed = nullptr,
                    .found = of_found.as<FoundPair>(),
                    .handed_count = counter + handed,
                    .found_count = counter + found_pairs,
                    .handed_room = job.lists.handed,
                    .found_room = found_room,
                    .stack = job.lists.stack,
                    .turn = job.lists.turn};
  for (int round = 0; task.count > 0; ++round) {
    fill_bytes(nullptr, counter, 0, found_pairs * 4);
    task.handed = lists[round % 2].as<HandedNodes>();
    constexpr std::int64_t kWarps = kDistanceThreads / 32;
    launch(nullptr, "find_nearest_pairs", find_nearest_pairs,
           std::min<std::int64_t>(kManyBlocks, (task.count + kWarps - 1) / kWarps), kDistanceThreads, task);
    copy_out(counts, counter, sizeof counts);
    task.items = task.handed;
    task.count = std::min(counts[handed], job.lists.handed);
  }
  std::vector<FoundPair> found(std::min(counts[found_pairs], found_room));
  copy_out(states.data(), of_states.as<void>(), bytes_of(std::span(states)));
  copy_out(found.data(), of_found.as<void>(), bytes_of(std::span(found)));
  gather_answers(states, found, job.answers);
}

}  // namespace standoff::STANDOFF_PLATFORM
