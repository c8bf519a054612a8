// SPDX-License-Identifier: Apache-2.0
// Pairs of triangles: ClosePairs finds the pairs that bounding boxes and separating axes cannot exclude, PairBatch
// decides or measures eight of them at a time.
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>
#include <utility>

#include "collision/query_pair.h"
#include "geometry/triangle_pair.h"

namespace standoff::collision {

class ClosePairs {
 public:
  /// Excludes pairs that are farther apart than `limit`, if their boxes or planes show it. visit() returns false if
  /// more than `most_leaves` leaves have been compared with packets.
  ClosePairs(const QueryPair& pair, float limit, std::int64_t most_leaves = std::numeric_limits<std::int64_t>::max())
      : pair_(pair), kernels_(pair.kernels), limit_(limit), leaves_left_(most_leaves) {}

  bool is_exhausted() const { return leaves_left_ < 0; }

  static constexpr std::uint32_t kAllLanes = (1u << kLanes) - 1;

  /// Calls use(target index, probe index) for each close pair of a triangle in some lanes of a probe's packet, until it
  /// returns false. Returns false if it did.
  template <class Use>
  bool visit(std::uint32_t packet, std::uint32_t lanes, Use use) {
    if (front_level_ < 0) find_front();
    place(packet, lanes);
    for (int first = 0; first < front_count_; first += kLanes) {
      const Boxes16& boxes = front_boxes_[first / kLanes];
      const std::uint32_t reached = kernels_.overlapping(boxes, all_);
      for (std::uint32_t left = reached; left != 0; left &= left - 1)
        fetch_node(front_level_, front_[first + std::countr_zero(left)]);
      for (std::uint32_t left = reached; left != 0; left &= left - 1) {
        const int n = std::countr_zero(left);
        if (!enter(front_level_, front_[first + n], lane_of(boxes, n), use)) return false;
      }
    }
    return true;
  }

  /// The same for the triangles of a target's leaf and those of a probe's packet, however many there are. Calls with
  /// the same packet in a row place it once.
  template <class Use>
  bool visit_leaf(std::uint32_t leaf, std::uint32_t packet, Use use) {
    if (packet != packet_) place(packet, kAllLanes);
    return test_leaf(leaf, lanes_, use);
  }

 private:
  static constexpr std::uint32_t kNone = ~0u;

  // Transforms the triangles of a probe's packet into the target's frame.
  void place(std::uint32_t packet, std::uint32_t lanes) {
    kernels_.transform_triangles(pair_.transform, pair_.probe.body->bvh.triangles[packet], limit_, transformed_, boxes_,
                                 all_);
    packet_ = packet;
    lanes_ = lanes & ((1u << pair_.probe.body->bvh.children_of(0, packet)) - 1);
  }

  // The most nodes of the front: a few registers of boxes.
  static constexpr int kFront = 4 * kLanes;

  void fetch_node(int level, std::uint32_t node) const {
    fetch(pair_.target.body->bvh.boxes(level)[node]);
    if (level == 0) fetch(pair_.target.body->bvh.triangles[node]);
  }

  // Finds the nodes of the target's BVH that overlap the probe's box, at the deepest level with at most kFront of them:
  // traversals start there and not at the root.
  void find_front() {
    const BodyBvh& bvh = pair_.target.body->bvh;
    const FloatBox region = pair_.region(limit_);
    front_level_ = bvh.top();
    front_[0] = 0;
    front_count_ = 1;
    for (int axis = 0; axis < 3; ++axis) {
      std::fill_n(front_boxes_[0].low[axis], kLanes, kInfinity);
      std::fill_n(front_boxes_[0].high[axis], kLanes, -kInfinity);
      front_boxes_[0].low[axis][0] = -kInfinity, front_boxes_[0].high[axis][0] = kInfinity;
    }
    while (front_level_ > 0) {
      std::uint32_t next[kFront];
      Boxes16 boxes[kFront / kLanes];
      int count = 0;
      for (int n = 0; n < front_count_; ++n) {
        const Boxes16& children = bvh.boxes(front_level_)[front_[n]];
        std::uint32_t reached = kernels_.overlapping(children, region);
        if (count + std::popcount(reached) > kFront) return;
        for (; reached != 0; reached &= reached - 1, ++count) {
          const int lane = std::countr_zero(reached);
          next[count] = front_[n] * kLanes + static_cast<std::uint32_t>(lane);
          if (front_level_ > 1) fetch(bvh.boxes(front_level_ - 1)[next[count]]);
          for (int axis = 0; axis < 3; ++axis) {
            boxes[count / kLanes].low[axis][count % kLanes] = children.low[axis][lane];
            boxes[count / kLanes].high[axis][count % kLanes] = children.high[axis][lane];
          }
        }
      }
      for (int n = count; n % kLanes != 0; ++n)
        for (int axis = 0; axis < 3; ++axis)
          boxes[n / kLanes].low[axis][n % kLanes] = kInfinity, boxes[n / kLanes].high[axis][n % kLanes] = -kInfinity;
      std::copy_n(next, count, front_);
      std::copy_n(boxes, (count + kLanes - 1) / kLanes, front_boxes_);
      front_count_ = count;
      --front_level_;
      if (count == 0) return;
    }
  }

  // Visits a node whose box the packet reaches.
  template <class Use>
  bool enter(int level, std::uint32_t node, const FloatBox& box, Use& use) {
    if (level > 0) return descend(level, node, use);
    // Exclude the packet's triangles that do not reach the leaf's box.
    const std::uint32_t reaching = kernels_.overlapping(boxes_, box) & lanes_;
    return reaching == 0 || (--leaves_left_ >= 0 && test_leaf(node, reaching, use));
  }

  template <class Use>
  bool descend(int level, std::uint32_t node, Use& use) {
    const Boxes16& nodes = pair_.target.body->bvh.boxes(level)[node];
    const std::uint32_t reached = kernels_.overlapping(nodes, all_);
    for (std::uint32_t left = reached; left != 0; left &= left - 1)
      fetch_node(level - 1, node * kLanes + static_cast<std::uint32_t>(std::countr_zero(left)));
    for (std::uint32_t left = reached; left != 0; left &= left - 1) {
      const int n = std::countr_zero(left);
      if (!enter(level - 1, node * kLanes + static_cast<std::uint32_t>(n), lane_of(nodes, n), use)) return false;
    }
    return true;
  }

  template <class Use>
  bool test_leaf(std::uint32_t leaf, std::uint32_t lanes, Use& use) {
    const BodyBvh& bvh = pair_.target.body->bvh;
    const Boxes16& resting = bvh.boxes(0)[leaf];
    const TriangleSubset target{&bvh.triangles[leaf], &resting, kernels_.overlapping(resting, all_)};
    const TriangleSubset transformed{&transformed_, &boxes_, lanes};
    if (target.lanes == 0) return true;
    LanePair pairs[kLanes * kLanes];
    const bool target_first = std::popcount(target.lanes) >= std::popcount(transformed.lanes);
    const int count = target_first ? kernels_.close_pairs(target, transformed, limit_, pairs)
                                   : kernels_.close_pairs(transformed, target, limit_, pairs);
    for (int n = 0; n < count; ++n) {
      const std::uint32_t of_target = target_first ? pairs[n].a : pairs[n].b;
      const std::uint32_t of_probe = target_first ? pairs[n].b : pairs[n].a;
      if (!use(leaf * kLanes + of_target, packet_ * kLanes + of_probe)) return false;
    }
    return true;
  }

  const QueryPair& pair_;
  const Kernels& kernels_;
  const float limit_;
  std::int64_t leaves_left_;
  // The front: nodes of a level and their boxes. The level is -1 before the first visit.
  int front_level_ = -1, front_count_ = 0;
  std::uint32_t front_[kFront];
  Boxes16 front_boxes_[kFront / kLanes];
  // The current packet, in the target's frame.
  Triangle16 transformed_;
  Boxes16 boxes_;
  FloatBox all_;
  std::uint32_t packet_ = kNone, lanes_ = 0;
};

class PairBatch {
 public:
  explicit PairBatch(const QueryPair& pair)
      : pair_(pair),
        kernels_(pair.kernels),
        transform_p_(transform_of(pair.target.pose)),
        transform_q_(transform_of(pair.probe.pose)) {}

  bool full() const { return count_ == kPairs; }

  /// Adds a pair by its BVH indices. Requires that the batch is not full.
  void add(std::uint32_t target_index, std::uint32_t probe_index) {
    const auto put = [this](double(&to)[3][3][kPairs], const Corners& corners) {
      for (int k = 0; k < 3; ++k)
        to[k][0][count_] = corners[k].x, to[k][1][count_] = corners[k].y, to[k][2][count_] = corners[k].z;
    };
    put(pairs_.p, pair_.target.body->corners[target_index]);
    put(pairs_.q, pair_.probe.body->corners[probe_index]);
    target_[count_] = target_index, probe_[count_] = probe_index;
    ++count_;
  }

  /// Decides the pairs in the order in which they were added, and calls use(target index, probe index, intersecting,
  /// where), until it returns false. Returns false if it did. Empties the batch. If the pair intersects, `where()`
  /// returns its Penetration.
  template <class Use>
  bool settle(Use use) {
    PairOverlaps overlap;
    const int count = take(kernels_.overlap_pairs, overlap);
    const auto is = [](std::uint32_t bits, int n) { return (bits >> n & 1) != 0; };
    for (int n = 0; n < count; ++n) {
      const auto p = [&] { return pair_.target.world(target_[n]); };
      const auto q = [&] { return pair_.probe.world(probe_[n]); };
      const auto where = [&]() -> Penetration {
        if (is(overlap.unsure | overlap.inaccurate, n)) return penetration(p(), q());
        return {{overlap.point[0][n], overlap.point[1][n], overlap.point[2][n]},
                {overlap.normal[0][n], overlap.normal[1][n], overlap.normal[2][n]},
                overlap.depth[n]};
      };
      const bool intersecting = is(overlap.intersecting, n) || (is(overlap.unsure, n) && triangles_intersect(p(), q()));
      if (!use(target_[n], probe_[n], intersecting, where)) return false;
    }
    return true;
  }

  /// Measures the pairs, which must not intersect, and calls use(target index, probe index, squared distance, closest
  /// point of the target's triangle, closest point of the probe's triangle).
  template <class Use>
  void measure(Use use) {
    ClosestOfPairs found;
    const int count = take(kernels_.closest, found);
    for (int n = 0; n < count; ++n)
      use(target_[n], probe_[n], found.distance_sq[n], Vec3{found.on_p[0][n], found.on_p[1][n], found.on_p[2][n]},
          Vec3{found.on_q[0][n], found.on_q[1][n], found.on_q[2][n]});
  }

 private:
  // Runs a kernel on the pairs; returns their number.
  template <class Kernel, class Result>
  int take(Kernel kernel, Result& result) {
    if (count_ == 0) return 0;
    for (int n = count_; n < kPairs; ++n)
      for (int k = 0; k < 3; ++k)
        for (int axis = 0; axis < 3; ++axis)
          pairs_.p[k][axis][n] = pairs_.p[k][axis][0], pairs_.q[k][axis][n] = pairs_.q[k][axis][0];
    kernel(pairs_, pair_.target.moved ? &transform_p_ : nullptr, pair_.probe.moved ? &transform_q_ : nullptr, result);
    return std::exchange(count_, 0);
  }

  const QueryPair& pair_;
  const Kernels& kernels_;
  const DoubleTransform transform_p_, transform_q_;
  TrianglePairs pairs_;
  std::uint32_t target_[kPairs], probe_[kPairs];
  int count_ = 0;
};

}  // namespace standoff::collision
