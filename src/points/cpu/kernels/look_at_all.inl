// SPDX-License-Identifier: Apache-2.0
// The kernel that answers points one by one, down the BVH. It is for points that share few candidates: they are far
// apart compared with the size of the triangles around them.
//
// Each search begins at the node where the last one ended, which bounds the distance. Then it visits the nodes whose
// boxes are nearer than the bound, sixteen boxes or triangles at a time, the nearest box first.
#pragma once

#include "points/cpu/kernels/compare.inl"

namespace standoff::cpu::STANDOFF_TARGET {
namespace {

// Boxes are grown by the rounding error of coordinates; this share covers the arithmetic of box and bound. Of points
// that are not near (TriangleIndex::is_near) it also covers the rounding of their coordinates, which is at most 2^-22
// of their distance from any box.
constexpr float kBoxShare = 1 - 0x1p-20f;

// A node whose children are being visited.
struct Opened {
  alignas(64) float distance_sq[kLanes];  // lower bounds, by child
  std::uint32_t waiting;                  // bits of the children not visited yet
  std::uint32_t first;                    // the first child
  int level;                              // of the children
};

// The state of a point's search.
struct OnePoint {
  double local[3];  // relative to the middle of the index
  float at[3];
  float upper_sq;  // upper bound of the squared distance
  int near_count;  // of the table's triangles that may be nearest
};

// Queues the triangles that may still be nearest for comparison in double, and empties the list: it is full, or the
// search has ended.
STANDOFF_INLINE void settle(const BvhView& tree, OnePoint& p, int point, PointGroup& points, PairTable& table) {
  for (int n = 0; n < p.near_count; ++n)
    if (table.near[n].lower_sq <= p.upper_sq) add_pair(tree, table.near[n].place, point, points, table);
  p.near_count = 0;
}

STANDOFF_INLINE void measure_node(const BvhView& tree, std::uint32_t number, OnePoint& p, int point, PointGroup& points,
                                  PairTable& table) {
  const NodeFrames& frames = tree.frames[number];
  float at[3], farthest = 0;
  for (int axis = 0; axis < 3; ++axis) {
    at[axis] = static_cast<float>(p.local[axis] - frames.center[axis]);
    const float far = __builtin_fabsf(at[axis]);
    farthest = far > farthest ? far : farthest;
  }
  const Slack slack = slack_of(farthest, frames.extent);
  const WideFloat sq =
      distance_sq(load_frames(frames.frame), WidePoint{WideFloat(at[0]), WideFloat(at[1]), WideFloat(at[2])});
  const float upper = reduce_min(at_most(sq, slack));
  p.upper_sq = upper < p.upper_sq ? upper : p.upper_sq;
  const WideFloat lower = at_least(sq, slack);
  std::uint32_t near = less_equal(lower, WideFloat(p.upper_sq)).to_bits() & ((1u << size_of_node(tree, number)) - 1);
  if (near == 0) return;
  if (p.near_count + kLanes > PairTable::kMostNear) settle(tree, p, point, points, table);
  alignas(64) float lowers[kLanes];
  lower.store(lowers);
  for (; near != 0; near &= near - 1) {
    const int lane = __builtin_ctz(near);
    table.near[p.near_count++] = {number * kLanes + static_cast<unsigned>(lane), lowers[lane]};
  }
}

// Marks the children nearer than the bound as waiting; returns whether there are any.
STANDOFF_INLINE bool open_node(const BvhView& tree, std::uint32_t node, int level, const OnePoint& p, Opened& opened) {
  const Boxes16& boxes = tree.boxes[node];
  WideFloat sum(0);
  for (int axis = 0; axis < 3; ++axis) {
    const WideFloat at(p.at[axis]);
    const WideFloat outside =
        max(max(WideFloat::load(boxes.low[axis]) - at, at - WideFloat::load(boxes.high[axis])), WideFloat(0));
    sum = fma(outside, outside, sum);
  }
  sum = sum * WideFloat(kBoxShare);
  sum.store(opened.distance_sq);
  opened.level = level - 1;
  opened.first = tree.begin[level - 1] + kLanes * (node - tree.begin[level]);
  const std::uint32_t left = tree.begin[level] - opened.first;
  opened.waiting = less_equal(sum, WideFloat(p.upper_sq)).to_bits();
  if (left < kLanes) opened.waiting &= (1u << left) - 1;
  return opened.waiting != 0;
}

// Removes the nearest waiting child and returns it; kLanes if all are beyond the bound.
STANDOFF_INLINE int take_nearest(Opened& opened, float upper_sq) {
  const WideFloat sq = WideFloat::load(opened.distance_sq);
  const std::uint32_t near = opened.waiting & less_equal(sq, WideFloat(upper_sq)).to_bits();
  if (near == 0) return kLanes;
  int lane = __builtin_ctz(near);
  if ((near & (near - 1)) != 0) {
    const WideFloat nearest(reduce_min(select(mask_from_bits(near), sq, WideFloat(__builtin_inff()))));
    lane = __builtin_ctz(near & less_equal(sq, nearest).to_bits());
  }
  opened.waiting = near & ~(1u << lane);
  return lane;
}

void look_at_all(const BvhView& tree, PointGroup& points, PairTable& table) {
  table.pair_count = 0;
  std::uint32_t last = points.start;
  Opened opened[BvhView::kMostLevels];
  for (int n = 0; n < points.count; ++n) {
    OnePoint p;
    for (int axis = 0; axis < 3; ++axis) {
      p.local[axis] = points.at[n][axis] - (points.center[axis] - points.middle[axis]);
      p.at[axis] = static_cast<float>(p.local[axis]);
    }
    p.upper_sq = __builtin_inff();
    p.near_count = 0;
    measure_node(tree, last, p, n, points, table);
    const std::uint32_t begun = last;
    int depth = tree.top != 0 && open_node(tree, tree.begin[tree.top], tree.top, p, opened[0]) ? 1 : 0;
    while (depth != 0) {
      Opened& here = opened[depth - 1];
      const int lane = take_nearest(here, p.upper_sq);
      if (lane == kLanes) {
        --depth;
        continue;
      }
      const std::uint32_t node = here.first + static_cast<unsigned>(lane);
      if (here.level != 0) {
        if (open_node(tree, node, here.level, p, opened[depth])) ++depth;
        continue;
      }
      if (node == begun) continue;
      const float before = p.upper_sq;
      measure_node(tree, node, p, n, points, table);
      if (p.upper_sq < before) last = node;
    }
    settle(tree, p, n, points, table);
  }
  points.start = last;
  compare_pairs(tree, points, table);
}

}  // namespace
}  // namespace standoff::cpu::STANDOFF_TARGET
