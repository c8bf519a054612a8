// Triangles of the tree's body with the field body's triangles near them: what exact tests are made on.
#pragma once

#include <bit>

#include "collision/pair.h"

namespace standoff::collision {

class ClosePairs {
 public:
  /// Pairs farther from each other than `limit` are left out as far as boxes and the triangles' planes show it.
  ClosePairs(const Pair& pair, const Kernels& kernels, float limit) : pair_(pair), kernels_(kernels), limit_(limit) {}

  static constexpr std::uint32_t kAllLanes = (1u << kLanes) - 1;

  /// Calls use(place in the field's tree, place in the tree's tree) for the triangles in some lanes of a packet, until
  /// it returns false. False when it did.
  template <class Use>
  bool visit(std::uint32_t packet, std::uint32_t lanes, Use use) {
    if (front_level_ < 0) find_front();
    kernels_.place_faces(pair_.place, pair_.tree.body->tree.faces[packet], limit_, placed_, boxes_, all_);
    const auto count = static_cast<std::uint32_t>(pair_.tree.body->tree.order.size()) - packet * kLanes;
    packet_ = packet;
    lanes_ = count < kLanes ? lanes & ((1u << count) - 1) : lanes;
    for (int first = 0; first < front_count_; first += kLanes) {
      const Boxes& boxes = front_boxes_[first / kLanes];
      const std::uint32_t reached = kernels_.overlaps(boxes, all_);
      for (std::uint32_t left = reached; left != 0; left &= left - 1)
        fetch_node(front_level_, front_[first + std::countr_zero(left)]);
      for (std::uint32_t left = reached; left != 0; left &= left - 1) {
        const int n = std::countr_zero(left);
        if (!enter(front_level_, front_[first + n], lane_of(boxes, n), use)) return false;
      }
    }
    return true;
  }

 private:
  // Nodes that the tree's body reaches, at most: a few registers of boxes.
  static constexpr int kFront = 4 * kLanes;

  void fetch_node(int level, std::uint32_t node) const {
    fetch(pair_.field.body->tree.levels[level].boxes[node]);
    if (level == 0) fetch(pair_.field.body->tree.faces[node]);
  }

  // The nodes of the field's tree, as deep as so few will do, that the whole of the other body reaches: packets start
  // there and not at the top.
  void find_front() {
    const Tree& tree = pair_.field.body->tree;
    const FloatBox region = pair_.region(limit_);
    front_level_ = tree.top();
    front_[0] = 0;
    front_count_ = 1;
    for (int axis = 0; axis < 3; ++axis) {
      std::fill_n(front_boxes_[0].min[axis], kLanes, kNothing);
      std::fill_n(front_boxes_[0].max[axis], kLanes, -kNothing);
      front_boxes_[0].min[axis][0] = -kNothing, front_boxes_[0].max[axis][0] = kNothing;
    }
    while (front_level_ > 0) {
      std::uint32_t next[kFront];
      Boxes boxes[kFront / kLanes];
      int count = 0;
      for (int n = 0; n < front_count_; ++n) {
        const Boxes& children = tree.levels[front_level_].boxes[front_[n]];
        std::uint32_t reached = kernels_.overlaps(children, region);
        if (count + std::popcount(reached) > kFront) return;
        for (; reached != 0; reached &= reached - 1, ++count) {
          const int lane = std::countr_zero(reached);
          next[count] = front_[n] * kLanes + static_cast<std::uint32_t>(lane);
          if (front_level_ > 1) fetch(tree.levels[front_level_ - 1].boxes[next[count]]);
          for (int axis = 0; axis < 3; ++axis) {
            boxes[count / kLanes].min[axis][count % kLanes] = children.min[axis][lane];
            boxes[count / kLanes].max[axis][count % kLanes] = children.max[axis][lane];
          }
        }
      }
      for (int n = count; n % kLanes != 0; ++n)
        for (int axis = 0; axis < 3; ++axis)
          boxes[n / kLanes].min[axis][n % kLanes] = kNothing, boxes[n / kLanes].max[axis][n % kLanes] = -kNothing;
      std::copy_n(next, count, front_);
      std::copy_n(boxes, (count + kLanes - 1) / kLanes, front_boxes_);
      front_count_ = count;
      --front_level_;
      if (count == 0) return;
    }
  }

  // A node whose box the packet reaches.
  template <class Use>
  bool enter(int level, std::uint32_t node, const FloatBox& box, Use& use) {
    if (level > 0) return descend(level, node, use);
    // Which of the packet's triangles reach the leaf's box, before its sixteen triangles are looked at.
    const std::uint32_t reaching = kernels_.overlaps(boxes_, box) & lanes_;
    return reaching == 0 || meet(node, reaching, use);
  }

  template <class Use>
  bool descend(int level, std::uint32_t node, Use& use) {
    const Boxes& nodes = pair_.field.body->tree.levels[level].boxes[node];
    const std::uint32_t reached = kernels_.overlaps(nodes, all_);
    for (std::uint32_t left = reached; left != 0; left &= left - 1)
      fetch_node(level - 1, node * kLanes + static_cast<std::uint32_t>(std::countr_zero(left)));
    for (std::uint32_t left = reached; left != 0; left &= left - 1) {
      const int n = std::countr_zero(left);
      if (!enter(level - 1, node * kLanes + static_cast<std::uint32_t>(n), lane_of(nodes, n), use)) return false;
    }
    return true;
  }

  template <class Use>
  bool meet(std::uint32_t leaf, std::uint32_t lanes, Use& use) {
    const Tree& tree = pair_.field.body->tree;
    const Boxes& resting = tree.levels[0].boxes[leaf];
    const Packet field{&tree.faces[leaf], &resting, kernels_.overlaps(resting, all_)};
    const Packet placed{&placed_, &boxes_, lanes};
    if (field.lanes == 0) return true;
    LanePair pairs[kLanes * kLanes];
    const bool field_first = std::popcount(field.lanes) >= std::popcount(placed.lanes);
    const int count = field_first ? kernels_.close_lanes(field, placed, limit_, pairs)
                                  : kernels_.close_lanes(placed, field, limit_, pairs);
    for (int n = 0; n < count; ++n) {
      const std::uint32_t of_field = field_first ? pairs[n].a : pairs[n].b;
      const std::uint32_t of_tree = field_first ? pairs[n].b : pairs[n].a;
      if (!use(leaf * kLanes + of_field, packet_ * kLanes + of_tree)) return false;
    }
    return true;
  }

  const Pair& pair_;
  const Kernels& kernels_;
  const float limit_;
  // Nodes of one level and their boxes; no level before the first visit.
  int front_level_ = -1, front_count_ = 0;
  std::uint32_t front_[kFront];
  Boxes front_boxes_[kFront / kLanes];
  // The packet at work, in the field's frame.
  Faces placed_;
  Boxes boxes_;
  FloatBox all_;
  std::uint32_t packet_ = 0, lanes_ = 0;
};

}  // namespace standoff::collision
