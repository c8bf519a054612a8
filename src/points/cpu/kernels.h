// SPDX-License-Identifier: Apache-2.0
// The inner loops of queries at points, compiled once per instruction set (kernels_*.cpp) and chosen at run time. All
// sets give the same bits.
#pragma once

#include "field/cpu/kernels.h"
#include "points/cpu/point_group.h"
#include "standoff/execution.h"

namespace standoff::cpu {

struct PointKernels {
  /// Sets up the frames of node `number` of level 0. `center` is that of the boxes, grid units; scale: grid units per
  /// world unit.
  void (*make_frames)(const BvhView&, std::uint32_t number, double scale, const double (&center)[3], NodeFrames&);
  /// Lowers nearest_sq and nearest of all points of the group to the nearest of the candidates: triangles by their
  /// places, ascending within each node of level 0.
  void (*look_at)(const BvhView&, const std::uint32_t* candidates, std::int64_t count, PointGroup&, PointTable&);
  /// The same for all triangles, point by point.
  void (*look_at_all)(const BvhView&, PointGroup&, PairTable&);
  /// Finds the closest point of each triangle, and what part of it that is on. By the measure of
  /// geometry/triangle_distance.h: its distance has the bits that decided that the triangle is the nearest.
  void (*closest)(ClosestOfEight&);
  /// Adds up the solid angles of all triangles. `use`: how often each one counts, -1 to 1; null: all once.
  void (*add_solid_angles)(const BvhView&, const std::int8_t* use, SolidAngles&);
  /// The same as overlapping() in bvh/boxes16.h.
  std::uint32_t (*overlapping)(const Boxes16&, const FloatBox&);
};

/// The kernels for an instruction set; the best one there is for Simd::automatic. Throws Error{usage} where the
/// processor does not have the set.
const PointKernels& point_kernels_for(Simd simd);

}  // namespace standoff::cpu
