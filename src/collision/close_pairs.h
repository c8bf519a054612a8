// Triangles of the tree's body with the field body's triangles near them: what exact tests are made on.
#pragma once

#include <bit>

#include "collision/pair.h"

namespace difi::collision {

class ClosePairs {
 public:
  /// Pairs farther from each other than `limit` are left out as far as boxes and the triangles' planes show it.
  ClosePairs(const Pair& pair, const Kernels& kernels, float limit) : pair_(pair), kernels_(kernels), limit_(limit) {}

  /// Calls use(place in the field's tree, place in the tree's tree) for the lanes of a packet given as bits, until it
  /// returns false. False when it did.
  template <class Use>
  bool visit(std::uint32_t packet, std::uint32_t lanes, Use use) {
    kernels_.place_faces(pair_.place, pair_.tree.body->tree.faces[packet], limit_, placed_, boxes_);
    all_ = {};
    for (std::uint32_t left = lanes; left != 0; left &= left - 1) all_.include(box(boxes_, std::countr_zero(left)));
    packet_ = packet;
    lanes_ = lanes;
    return descend(pair_.field.body->tree.top(), 0, use);
  }

 private:
  // Asks for all lines of a packet before the first is needed.
  template <class T>
  static void fetch(const T& packet) {
    for (std::size_t line = 0; line < sizeof(T); line += 64)
      __builtin_prefetch(reinterpret_cast<const char*>(&packet) + line);
  }

  static FloatBox box(const Boxes& boxes, int lane) {
    FloatBox one;
    for (int axis = 0; axis < 3; ++axis) one.min[axis] = boxes.min[axis][lane], one.max[axis] = boxes.max[axis][lane];
    return one;
  }

  template <class Use>
  bool descend(int level, std::uint32_t node, Use& use) {
    const Boxes& nodes = pair_.field.body->tree.levels[level].boxes[node];
    if (level > 1) {
      const std::uint32_t reached = kernels_.overlaps(nodes, all_);
      const Level& below = pair_.field.body->tree.levels[level - 1];
      for (std::uint32_t left = reached; left != 0; left &= left - 1)
        fetch(below.boxes[node * kLanes + std::countr_zero(left)]);
      for (std::uint32_t left = reached; left != 0; left &= left - 1)
        if (!descend(level - 1, node * kLanes + std::countr_zero(left), use)) return false;
      return true;
    }
    if (level == 0) return meet(node, lanes_, use);
    // Which of the packet's triangles reach the box of a leaf, before its sixteen triangles are fetched.
    const std::uint32_t reached = kernels_.overlaps(nodes, all_);
    for (std::uint32_t left = reached; left != 0; left &= left - 1) {
      const std::uint32_t leaf = node * kLanes + std::countr_zero(left);
      fetch(pair_.field.body->tree.levels[0].boxes[leaf]);
      fetch(pair_.field.body->tree.faces[leaf]);
    }
    for (std::uint32_t left = reached; left != 0; left &= left - 1) {
      const int leaf = std::countr_zero(left);
      const std::uint32_t reaching = kernels_.overlaps(boxes_, box(nodes, leaf)) & lanes_;
      if (reaching != 0 && !meet(node * kLanes + leaf, reaching, use)) return false;
    }
    return true;
  }

  // Sixteen against sixteen, one by one on the side that has fewer left.
  template <class Use>
  bool meet(std::uint32_t leaf, std::uint32_t lanes, Use& use) {
    const Boxes& resting = pair_.field.body->tree.levels[0].boxes[leaf];
    const Faces& faces = pair_.field.body->tree.faces[leaf];
    std::uint32_t others = kernels_.overlaps(resting, all_);
    if (std::popcount(others) < std::popcount(lanes)) {
      for (; others != 0; others &= others - 1) {
        const int other = std::countr_zero(others);
        std::uint32_t left = kernels_.overlaps(boxes_, box(resting, other)) & lanes;
        if (left != 0) left &= kernels_.not_parted(placed_, faces, other, limit_);
        for (; left != 0; left &= left - 1)
          if (!use(leaf * kLanes + other, packet_ * kLanes + std::countr_zero(left))) return false;
      }
      return true;
    }
    for (; lanes != 0; lanes &= lanes - 1) {
      const int lane = std::countr_zero(lanes);
      std::uint32_t left = kernels_.overlaps(resting, box(boxes_, lane)) & others;
      if (left != 0) left &= kernels_.not_parted(faces, placed_, lane, limit_);
      for (; left != 0; left &= left - 1)
        if (!use(leaf * kLanes + std::countr_zero(left), packet_ * kLanes + lane)) return false;
    }
    return true;
  }

  const Pair& pair_;
  const Kernels& kernels_;
  const float limit_;
  Faces placed_;
  Boxes boxes_;
  FloatBox all_;
  std::uint32_t packet_ = 0, lanes_ = 0;
};

}  // namespace difi::collision
