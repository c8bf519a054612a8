// SPDX-License-Identifier: Apache-2.0
// The kernels of thin bands that tell which bricks triangles reach: reached_cells() of eight triangles at a time, and
// the distances of a long triangle from eight bricks' centres.
#pragma once

#include "field/cpu/kernels/triangle_frames.inl"
#include "field/cpu/regions.h"

namespace standoff::cpu::STANDOFF_TARGET {
namespace {

// The boxes of eight triangles, world units: axis, lane.
struct BoxLanes {
  alignas(64) double low[3][kReachLanes];
  alignas(64) double high[3][kReachLanes];
};

template <bool kPacked>
STANDOFF_INLINE void load_boxes(const MeshMemory& mesh, const std::uint32_t* triangles, BoxLanes& boxes) {
  for (int lane = 0; lane < kReachLanes; ++lane) {
    double room[3][3];
    const double* corner[3];
    for (int which = 0; which < 3; ++which)
      corner[which] = corner_of<kPacked>(mesh, triangles[lane], which, room[which]);
    for (int axis = 0; axis < 3; ++axis) {
      const double a = corner[0][axis], b = corner[1][axis], c = corner[2][axis];
      boxes.low[axis][lane] = min(a, min(b, c));
      boxes.high[axis][lane] = max(a, max(b, c));
    }
  }
}

// How far the triangles reach beyond their boxes, in samples.
STANDOFF_INLINE WideDouble reaches(const BlockLattice& l, const std::uint32_t* triangles, const Region* regions,
                                   int axis) {
  if (!regions) return WideDouble(l.reach[axis]);
  alignas(64) double reach[kReachLanes];
  for (int lane = 0; lane < kReachLanes; ++lane) reach[lane] = regions[triangles[lane]].reach[axis];
  return WideDouble::load(reach) * WideDouble(1 / l.unit[axis]) + WideDouble(2 * kBoxSlack);
}

// The bricks of reached_cells(), or fewer for triangles with regions.
void reached_bricks(const BlockLattice& l, const MeshMemory& mesh, const std::uint32_t* triangles,
                    const Region* regions, BrickRanges& ranges) {
  static_assert(kReachLanes == WideDouble::kLanes);
  BoxLanes boxes;
  if (mesh.packed)
    load_boxes<true>(mesh, triangles, boxes);
  else
    load_boxes<false>(mesh, triangles, boxes);
  const WideDouble zero(0.0), up(1 - kBoxSlack), one(1.0);
  for (int axis = 0; axis < 3; ++axis) {
    const WideDouble origin(l.origin[axis]), to_samples(l.to_samples[axis]), before(l.first[axis]),
        reach = reaches(l, triangles, regions, axis), past(static_cast<double>(l.size[axis]));
    const WideDouble from = (WideDouble::load(boxes.low[axis]) - origin) * to_samples - before - reach;
    const WideDouble to = (WideDouble::load(boxes.high[axis]) - origin) * to_samples - before + reach;
    std::int32_t(&low)[kReachLanes] = ranges.low[axis], (&high)[kReachLanes] = ranges.high[axis];
    store_truncated(low, min(max(from + up, zero), past));
    store_truncated(high, min(max(to + one, zero), past));
    for (int lane = 0; lane < kReachLanes; ++lane) {
      const std::int32_t first = low[lane], last = high[lane] - 1;
      low[lane] = first / kBrickSide;
      high[lane] = last < first ? -1 : last / kBrickSide;
    }
  }
}

STANDOFF_INLINE Linear<WideDouble> in_all_lanes(const Linear<double>& f) {
  return {{WideDouble(f.g.x), WideDouble(f.g.y), WideDouble(f.g.z)}, WideDouble(f.c)};
}
STANDOFF_INLINE HalfTriangle<WideDouble> in_all_lanes(const HalfTriangle<double>& half) {
  return {WideDouble(half.leg), WideDouble(half.length), WideDouble(half.nx), WideDouble(half.ny)};
}

unsigned within(const TriangleFrame<double>& frame, const double (&at)[3][kReachLanes], double reach_sq) {
  const TriangleFrame<WideDouble> f{in_all_lanes(frame.q), in_all_lanes(frame.y), in_all_lanes(frame.z),
                                    in_all_lanes(frame.left), in_all_lanes(frame.right)};
  return ~less(WideDouble(reach_sq), distance_sq(f, load_points(at))).to_bits() & ((1u << kReachLanes) - 1);
}

}  // namespace
}  // namespace standoff::cpu::STANDOFF_TARGET
