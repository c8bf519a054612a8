// SPDX-License-Identifier: Apache-2.0
// The kernel that answers a group of points: which of the candidates is nearest to each.
//
// Sixteen candidates at a time are set up in float and measured from the corners of the points' box. A candidate beats
// a reference q, a point of the surface, at a point x of the box if it holds a p with |x-p|^2 < |x-q|^2. For a given p
// the two sides differ by a linear function of x, so p beats q at a corner too: a candidate whose distance from each
// corner is more than that of q is out. The references are the points of the candidates nearest to the corners.
//
// Those left are measured from the points, sixteen points at a time. All that rounding cannot tell from the nearest are
// compared in double: eight pairs of point and triangle at a time.
#pragma once

#include "field/cpu/kernels/target.inl"
#include "field/cpu/kernels/triangle_frames.inl"
#include "geometry/triangle_distance.h"
#include "points/cpu/kernels.h"

namespace standoff::cpu::STANDOFF_TARGET {
namespace {

// A slack s in the distance d, allowed for without a root: (d-s)^2 >= d^2 (1-a) - s^2/a, (d+s)^2 <= d^2 (1+a) +
// s^2 (1+1/a). Any a is safe; it decides how many triangles are compared in double for nothing. The other 2^-20 cover
// the rounding of these lines themselves.
constexpr float kShareOfSlack = 0x1p-13f, kShare = kShareOfSlack + 0x1p-20f;
constexpr float kSlackSq = 1 + 1 / kShareOfSlack;
// What a distance from a frame may be off by: a share of the largest coordinate, with a quarter more for the rounding
// of the coordinates themselves, and what is lost where a side shorter than the root of kLeastLengthSq counts as zero.
constexpr float kSlackOfFrame = 1.25f * kFrameError, kLeastSlack = 2e-6f;

// Sets up candidates first to first + 15; past the end the last one again, which changes nothing.
STANDOFF_INLINE void set_up_group(const PointCandidates& c, std::int64_t first, const PointGroup& points, float extent,
                                  PointTable::Group& to) {
  alignas(64) CornerRows rows;
  for (int lane = 0; lane < kLanes; ++lane) {
    const std::int64_t n = first + lane < c.count ? first + lane : c.count - 1;
    const TriangleCorners& t = c.corners[c.entries[n]];
    for (int which = 0; which < 3; ++which) store_local(rows[which][lane], t.at[which], points.scale, points.center);
  }
  const auto corner = [&](int which) __attribute__((always_inline)) {
    return WidePoint{load_column(rows[which], 0), load_column(rows[which], 1), load_column(rows[which], 2)};
  };
  const WidePoint a = corner(0), b = corner(1), d = corner(2);
  store_frames(make_frame(a, b, d, WideFloat(kLeastLengthSq)), to.frame);
  WideFloat farthest(extent);
  for (int axis = 0; axis < 3; ++axis)
    farthest = max(farthest, max(abs(component(a, axis)), max(abs(component(b, axis)), abs(component(d, axis)))));
  const WideFloat slack = fma(farthest, WideFloat(kSlackOfFrame), WideFloat(kLeastSlack));
  (slack * slack * WideFloat(kSlackSq)).store(to.slack_sq);
}

STANDOFF_INLINE WideFloat at_least(const WideFloat& sq, const WideFloat& slack_sq) {
  return fma(sq, WideFloat(1 - kShare), -slack_sq);
}
STANDOFF_INLINE WideFloat at_most(const WideFloat& sq, const WideFloat& slack_sq) {
  return fma(sq, WideFloat(1 + kShare), slack_sq);
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

// A point of the surface near each corner of the box: how far, squared, each of them is from each corner at most.
struct CornerReferences {
  alignas(64) float sq[PointTable::kCorners][kLanes];  // reference, corner
};

STANDOFF_INLINE void find_references(const PointTable& table, int groups, const PointGroup& points,
                                     CornerReferences& references) {
  const WidePoint corners = box_corners(points);
  for (int n = 0; n < PointTable::kCorners; ++n) {
    WideFloat best(__builtin_inff());
    WideUint group(0u);
    for (int g = 0; g < groups; ++g) {
      const WideFloat sq = WideFloat::load(table.groups[g].corner_sq[n]);
      group = select(less(sq, best), WideUint(static_cast<std::uint32_t>(g)), group);
      best = min(sq, best);
    }
    alignas(64) std::uint32_t of_lane[kLanes];
    group.store(of_lane);
    const auto lane = static_cast<std::uint32_t>(__builtin_ctz(equal(best, WideFloat(reduce_min(best))).to_bits()));
    const PointTable::Group& found = table.groups[of_lane[lane]];
    const TriangleFrame<WideFloat> frame = frame_of_lane<WideFloat>(found.frame, lane);
    const WidePoint off = closest_in_frame(frame, box_corner(points, n)) - corners;
    at_most(dot(off, off), WideFloat(found.slack_sq[lane])).store(references.sq[n]);
  }
}

// The lanes of a group that no reference beats at all corners.
STANDOFF_INLINE std::uint32_t unbeaten(const PointTable::Group& g, const CornerReferences& references) {
  WideFloat at[PointTable::kCorners];
  for (int corner = 0; corner < PointTable::kCorners; ++corner) at[corner] = WideFloat::load(g.corner_sq[corner]);
  std::uint32_t kept = 0xffff;
  for (int n = 0; n < PointTable::kCorners && kept != 0; ++n) {
    Mask beaten = less(WideFloat(references.sq[n][0]), at[0]);
    for (int corner = 1; corner < PointTable::kCorners; ++corner)
      beaten = beaten & less(WideFloat(references.sq[n][corner]), at[corner]);
    kept &= ~beaten.to_bits();
  }
  return kept;
}

// Chooses candidates of the table for the points; returns how many.
STANDOFF_INLINE int choose(const PointGroup& points, int groups, std::int64_t left, PointTable& table) {
  for (int g = 0; g < groups; ++g) {
    const TriangleFrame<WideFloat> frames = load_frames(table.groups[g].frame);
    const WideFloat slack_sq = WideFloat::load(table.groups[g].slack_sq);
    for (int corner = 0; corner < PointTable::kCorners; ++corner)
      at_least(distance_sq(frames, box_corner(points, corner)), slack_sq).store(table.groups[g].corner_sq[corner]);
  }
  CornerReferences references;
  find_references(table, groups, points, references);
  int kept = 0;
  for (int g = 0; g < groups; ++g) {
    std::uint32_t lanes = unbeaten(table.groups[g], references);
    if (left - g * kLanes < kLanes) lanes &= (1u << (left - g * kLanes)) - 1;
    for (; lanes != 0; lanes &= lanes - 1)
      table.kept[kept++] = static_cast<std::uint16_t>(g * kLanes + __builtin_ctz(lanes));
  }
  return kept;
}

// Measures the kept candidates from all points, and lists the pairs that may be nearest; returns how many.
STANDOFF_INLINE int measure(const PointCandidates& c, std::int64_t first, int kept, PointGroup& points,
                            PointTable& table) {
  const int vectors = (points.count + kLanes - 1) / kLanes;
  for (int n = 0; n < kept; ++n) {
    const PointTable::Group& g = table.groups[table.kept[n] / kLanes];
    const std::uint32_t lane = table.kept[n] % kLanes;
    const TriangleFrame<WideFloat> frame = frame_of_lane<WideFloat>(g.frame, lane);
    const WideFloat slack_sq(g.slack_sq[lane]);
    for (int v = 0; v < vectors; ++v) {
      const WidePoint p{WideFloat::load(points.local[0] + v * kLanes), WideFloat::load(points.local[1] + v * kLanes),
                        WideFloat::load(points.local[2] + v * kLanes)};
      const WideFloat sq = distance_sq(frame, p);
      min(at_most(sq, slack_sq), WideFloat::load(points.upper_sq + v * kLanes)).store(points.upper_sq + v * kLanes);
      at_least(sq, slack_sq).store(table.lower_sq[n] + v * kLanes);
    }
  }
  int pairs = 0;
  for (int v = 0; v < vectors; ++v) {
    const int used = points.count - v * kLanes < kLanes ? points.count - v * kLanes : kLanes;
    const std::uint32_t in_use = used == kLanes ? 0xffffu : (1u << used) - 1;
    const WideFloat upper = WideFloat::load(points.upper_sq + v * kLanes);
    for (int n = 0; n < kept; ++n) {
      std::uint32_t near = less_equal(WideFloat::load(table.lower_sq[n] + v * kLanes), upper).to_bits() & in_use;
      for (; near != 0; near &= near - 1)
        table.pairs[pairs++] = {c.entries[first + table.kept[n]],
                                static_cast<std::uint32_t>(v * kLanes + __builtin_ctz(near))};
    }
  }
  return pairs;
}

// Eight pairs in double.
STANDOFF_INLINE void compare(const PointCandidates& c, int pairs, PointGroup& points, const PointTable& table) {
  constexpr int kPairs = WideDouble::kLanes;
  for (int first = 0; first < pairs; first += kPairs) {
    alignas(64) double corner[3][3][kPairs];
    for (int lane = 0; lane < kPairs; ++lane) {
      const PointTable::Pair& pair = table.pairs[first + lane < pairs ? first + lane : pairs - 1];
      const double(&at)[3][3] = c.corners[pair.entry].at;
      const double(&p)[3] = points.world[pair.point];
      for (int which = 0; which < 3; ++which)
        for (int axis = 0; axis < 3; ++axis) corner[which][axis][lane] = at[which][axis] - p[axis];
    }
    const WideDouble scale(points.scale);
    const auto scaled = [&](int which) __attribute__((always_inline)) { return load_points(corner[which]) * scale; };
    alignas(64) double sq[kPairs];
    origin_distance_sq(scaled(0), scaled(1), scaled(2)).store(sq);
    for (int lane = 0; lane < kPairs && first + lane < pairs; ++lane) {
      const PointTable::Pair& pair = table.pairs[first + lane];
      const std::uint32_t triangle = c.index[pair.entry];
      double& best = points.nearest_sq[pair.point];
      if (sq[lane] > best || (sq[lane] == best && triangle >= points.nearest[pair.point])) continue;
      best = sq[lane];
      points.nearest[pair.point] = triangle;
    }
  }
}

void look_at(const PointCandidates& c, PointGroup& points, PointTable& table) {
  const float extent = points.half[0] < points.half[1]
                           ? (points.half[1] < points.half[2] ? points.half[2] : points.half[1])
                           : (points.half[0] < points.half[2] ? points.half[2] : points.half[0]);
  for (std::int64_t first = 0; first < c.count; first += PointTable::kMost) {
    const std::int64_t left = c.count - first;
    const int groups = left < PointTable::kMost ? static_cast<int>((left + kLanes - 1) / kLanes) : PointTable::kGroups;
    for (int g = 0; g < groups; ++g) set_up_group(c, first + g * kLanes, points, extent, table.groups[g]);
    const int kept = choose(points, groups, left, table);
    compare(c, measure(c, first, kept, points, table), points, table);
  }
}

}  // namespace
}  // namespace standoff::cpu::STANDOFF_TARGET
