// SPDX-License-Identifier: Apache-2.0
// The kernel that answers a group of points from a list of candidates.
//
// First the candidates are measured from the corners of the points' box, sixteen of a node at a time. Let q, the
// reference, be a point of the surface. A candidate beats q at a point x of the box if it holds a point p with
// |x-p|^2 < |x-q|^2. The difference of both sides is linear in x, so p beats q at some corner too: a candidate that is
// farther than q from every corner is dropped. The references are the candidates' closest points to the corners.
//
// If candidates are few, none is dropped: measuring them costs less than choosing.
//
// Then the candidates left are measured from the points, sixteen points at a time. Those that rounding cannot tell from
// the nearest are compared in double.
#pragma once

#include "points/cpu/kernels/compare.inl"

namespace standoff::cpu::STANDOFF_TARGET {
namespace {

STANDOFF_INLINE Slack slack_of(const PointTable::Node& node) { return {node.slack_share, node.slack_sq}; }

STANDOFF_INLINE float most_of(const float (&v)[3]) {
  const float xy = v[0] > v[1] ? v[0] : v[1];
  return xy > v[2] ? xy : v[2];
}

// Fills the table with the nodes of the candidates from `first` on, while there is room; returns the first candidate
// left.
STANDOFF_INLINE std::int64_t fill_table(const BvhView& tree, const std::uint32_t* candidates, std::int64_t first,
                                        std::int64_t count, const PointGroup& points, int& nodes, PointTable& table) {
  nodes = 0;
  while (first < count && nodes < PointTable::kNodes) {
    PointTable::Node& node = table.nodes[nodes++];
    node.number = candidates[first] / kLanes;
    node.lanes = 0;
    for (; first < count && candidates[first] / kLanes == node.number; ++first)
      node.lanes |= 1u << candidates[first] % kLanes;
    const NodeFrames& frames = tree.frames[node.number];
    float farthest[3];
    for (int axis = 0; axis < 3; ++axis) {
      node.offset[axis] = static_cast<float>(points.middle[axis] - frames.center[axis]);
      farthest[axis] = __builtin_fabsf(node.offset[axis]) + points.half[axis];
    }
    const Slack slack = slack_of(most_of(farthest), frames.extent);
    node.slack_share = slack.share;
    node.slack_sq = slack.sq;
  }
  return first;
}

STANDOFF_INLINE WidePoint moved(const WidePoint& p, const float (&by)[3]) {
  return {p.x + WideFloat(by[0]), p.y + WideFloat(by[1]), p.z + WideFloat(by[2])};
}

// Corner n of the box of the points.
STANDOFF_INLINE WidePoint box_corner(const PointGroup& points, int n) {
  const auto side = [&](int axis) __attribute__((always_inline)) {
    return WideFloat((n >> axis & 1) != 0 ? points.half[axis] : -points.half[axis]);
  };
  return {side(0), side(1), side(2)};
}
// Corner n in lane n, and again in lane 8 + n.
STANDOFF_INLINE WidePoint box_corners(const PointGroup& points) {
  const auto side = [&](int axis, std::uint32_t lanes) __attribute__((always_inline)) {
    return select(mask_from_bits(lanes), WideFloat(points.half[axis]), WideFloat(-points.half[axis]));
  };
  return {side(0, 0xaaaa), side(1, 0xcccc), side(2, 0xf0f0)};
}

// The references, one per corner of the box: upper bounds of their squared distances from each corner.
struct CornerReferences {
  alignas(64) float sq[PointTable::kCorners][kLanes];  // reference, corner
};

STANDOFF_INLINE void find_references(const BvhView& tree, const PointTable& table, int nodes, const PointGroup& points,
                                     CornerReferences& references) {
  const WidePoint corners = box_corners(points);
  for (int n = 0; n < PointTable::kCorners; ++n) {
    WideFloat best(__builtin_inff());
    WideUint found(0u);
    for (int k = 0; k < nodes; ++k) {
      const WideFloat sq = WideFloat::load(table.corner_sq[k][n]);
      found = select(less(sq, best), WideUint(static_cast<std::uint32_t>(k)), found);
      best = min(sq, best);
    }
    alignas(64) std::uint32_t of_lane[kLanes];
    found.store(of_lane);
    const auto lane = static_cast<std::uint32_t>(__builtin_ctz(equal(best, WideFloat(reduce_min(best))).to_bits()));
    const PointTable::Node& node = table.nodes[of_lane[lane]];
    const TriangleFrame<WideFloat> frame = frame_of_lane<WideFloat>(tree.frames[node.number].frame, lane);
    const WidePoint off =
        closest_in_frame(frame, moved(box_corner(points, n), node.offset)) - moved(corners, node.offset);
    at_most(dot(off, off), slack_of(node)).store(references.sq[n]);
  }
}

// The lanes of a node that no reference beats at all corners.
STANDOFF_INLINE std::uint32_t unbeaten(const float (&corner_sq)[PointTable::kCorners][kLanes],
                                       const CornerReferences& references) {
  WideFloat at[PointTable::kCorners];
  for (int corner = 0; corner < PointTable::kCorners; ++corner) at[corner] = WideFloat::load(corner_sq[corner]);
  std::uint32_t left = 0xffff;
  for (int n = 0; n < PointTable::kCorners && left != 0; ++n) {
    Mask beaten = less(WideFloat(references.sq[n][0]), at[0]);
    for (int corner = 1; corner < PointTable::kCorners; ++corner)
      beaten = beaten & less(WideFloat(references.sq[n][corner]), at[corner]);
    left &= ~beaten.to_bits();
  }
  return left;
}

// Whether choosing costs less than measuring the candidates that it is likely to drop, half of them. The unit of cost
// is measuring one triangle from sixteen points, or sixteen triangles from one point.
STANDOFF_INLINE bool is_worth_choosing(const PointTable& table, int nodes, const PointGroup& points) {
  int candidates = 0;
  for (int k = 0; k < nodes; ++k) candidates += __builtin_popcount(table.nodes[k].lanes);
  const int vectors = (points.count + kLanes - 1) / kLanes;
  return candidates * vectors > 2 * PointTable::kCorners * (nodes + 2);
}

STANDOFF_INLINE int keep_all(int nodes, PointTable& table) {
  int kept = 0;
  for (int k = 0; k < nodes; ++k)
    for (std::uint32_t lanes = table.nodes[k].lanes; lanes != 0; lanes &= lanes - 1)
      table.kept[kept++] = static_cast<std::uint16_t>(k * kLanes + __builtin_ctz(lanes));
  return kept;
}

// Keeps the candidates of the table that may be the nearest of a point; returns their number.
STANDOFF_INLINE int choose(const BvhView& tree, const PointGroup& points, int nodes, PointTable& table) {
  for (int k = 0; k < nodes; ++k) {
    const PointTable::Node& node = table.nodes[k];
    const TriangleFrame<WideFloat> frames = load_frames(tree.frames[node.number].frame);
    for (int corner = 0; corner < PointTable::kCorners; ++corner)
      at_least(distance_sq(frames, moved(box_corner(points, corner), node.offset)), slack_of(node))
          .store(table.corner_sq[k][corner]);
  }
  CornerReferences references;
  find_references(tree, table, nodes, points, references);
  int kept = 0;
  for (int k = 0; k < nodes; ++k)
    for (std::uint32_t lanes = unbeaten(table.corner_sq[k], references) & table.nodes[k].lanes; lanes != 0;
         lanes &= lanes - 1)
      table.kept[kept++] = static_cast<std::uint16_t>(k * kLanes + __builtin_ctz(lanes));
  return kept;
}

// Measures kept candidates from all points, and queues those that may be nearest for comparison in double.
STANDOFF_INLINE void measure(const BvhView& tree, const std::uint16_t* kept, int count, PointGroup& points,
                             PointTable& table) {
  const int vectors = (points.count + kLanes - 1) / kLanes;
  for (int n = 0; n < count; ++n) {
    const PointTable::Node& node = table.nodes[kept[n] / kLanes];
    const TriangleFrame<WideFloat> frame =
        frame_of_lane<WideFloat>(tree.frames[node.number].frame, kept[n] % static_cast<unsigned>(kLanes));
    for (int v = 0; v < vectors; ++v) {
      const int at = v * kLanes;
      const WidePoint p = moved({WideFloat::load(points.local[0] + at), WideFloat::load(points.local[1] + at),
                                 WideFloat::load(points.local[2] + at)},
                                node.offset);
      const WideFloat sq = distance_sq(frame, p);
      min(at_most(sq, slack_of(node)), WideFloat::load(points.upper_sq + at)).store(points.upper_sq + at);
      at_least(sq, slack_of(node)).store(table.lower_sq[n] + at);
    }
  }
  for (int v = 0; v < vectors; ++v) {
    const int at = v * kLanes;
    const std::uint32_t in_use = points.count - at < kLanes ? (1u << (points.count - at)) - 1 : 0xffffu;
    const WideFloat upper = WideFloat::load(points.upper_sq + at);
    for (int n = 0; n < count; ++n)
      for (std::uint32_t near = less_equal(WideFloat::load(table.lower_sq[n] + at), upper).to_bits() & in_use;
           near != 0; near &= near - 1)
        add_pair(tree, table.nodes[kept[n] / kLanes].number * kLanes + kept[n] % static_cast<unsigned>(kLanes),
                 at + __builtin_ctz(near), points, table);
  }
}

void look_at(const BvhView& tree, const std::uint32_t* candidates, std::int64_t count, PointGroup& points,
             PointTable& table) {
  table.pair_count = 0;
  for (std::int64_t first = 0; first < count;) {
    int nodes = 0;
    first = fill_table(tree, candidates, first, count, points, nodes, table);
    const int kept =
        is_worth_choosing(table, nodes, points) ? choose(tree, points, nodes, table) : keep_all(nodes, table);
    for (int n = 0; n < kept; n += PointTable::kMostKept)
      measure(tree, table.kept + n, kept - n < PointTable::kMostKept ? kept - n : PointTable::kMostKept, points, table);
  }
  compare_pairs(tree, points, table);
}

}  // namespace
}  // namespace standoff::cpu::STANDOFF_TARGET
