// SPDX-License-Identifier: Apache-2.0
// The kernel that answers points one by one, down the hierarchy of boxes: for points that are far apart beside the
// triangles around them, and so have few candidates in common.
//
// A point begins at the node where the last one ended, which bounds its distance. Then nodes are visited whose boxes
// are nearer than the bound, sixteen boxes or triangles at a time, the nearest box first.
#pragma once

#include "points/cpu/kernels/compare.inl"

namespace standoff::cpu::STANDOFF_TARGET {
namespace {

// Boxes are grown by what the rounding of coordinates takes; the arithmetic of box and bound takes this share.
constexpr float kBoxShare = 1 - 0x1p-20f;

// A node that was opened: which of its parts wait to be visited, and how far they are at least.
struct Opened {
  alignas(64) float distance_sq[kLanes];
  std::uint32_t waiting;  // bits
  std::uint32_t first;    // node
  int level;              // of the parts
};

// A point while it is answered.
struct OnePoint {
  double local[3];  // relative to the middle of the index
  float at[3];
  float upper_sq;
  int near_count;
};

// Compares the triangles that may be nearest so far: there are too many of them, or no more.
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

// Has the parts of a node wait that are nearer than the bound; returns whether there are any.
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

// Takes the nearest waiting part out; kLanes if all are beyond the bound.
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
