// SPDX-License-Identifier: Apache-2.0
// The triangles of the target whose boxes overlap a box: a warp goes down the target's BVH, two packets of sixteen at a
// time.
#pragma once

#include "collision/cuda/node_stack.cuh"

namespace standoff::STANDOFF_PLATFORM {

/// Low sides, then high ones.
struct FlatBox {
  float side[6];
};
STANDOFF_DEVICE bool overlap(const FlatBox& a, const FlatBox& b) {
  bool overlapping = true;
  for (int axis = 0; axis < 3; ++axis)
    overlapping = overlapping && a.side[axis] <= b.side[3 + axis] && a.side[3 + axis] >= b.side[axis];
  return overlapping;
}
STANDOFF_DEVICE FlatBox box_in(const collision::Aabb16& boxes, std::uint32_t n) {
  FlatBox box;
  for (int axis = 0; axis < 3; ++axis) box.side[axis] = boxes.min[axis][n], box.side[3 + axis] = boxes.max[axis][n];
  return box;
}

/// Calls use(this lane has one, its BVH index, its box) with triangles, all lanes together, until it returns
/// false. False, with triangles left out, where `words`, shared memory for `capacity` packets, did not suffice.
template <class Use>
STANDOFF_DEVICE bool for_overlapping_boxes(const FlatBox& box, const DeviceModelView& model, std::uint32_t* words,
                                           int capacity, Use use) {
  NodeStack<std::uint32_t> nodes(words, capacity, packet_word(model.top, 0));
  while (!nodes.empty()) {
    const std::uint32_t word = nodes.take(0, kNoPacket);
    const int level = level_of(word);
    const std::uint32_t child = packet_of(word) * kLanes + lane_in_warp() % kLanes;
    FlatBox own{};
    bool near = word != kNoPacket;
    if (near) {
      own = box_in(model.boxes[level][packet_of(word)], lane_in_warp() % kLanes);
      near = overlap(own, box);
    }
    const std::uint32_t inner = __ballot_sync(kWarp, near && level > 0);
    if (!nodes.put(inner, __popc(inner & lanes_below(lane_in_warp())), packet_word(level - 1, child))) return false;
    const bool leaf = near && level == 0;
    if (__ballot_sync(kWarp, leaf) != 0 && !use(leaf, child, own)) return true;
  }
  return true;
}

}  // namespace standoff::STANDOFF_PLATFORM
