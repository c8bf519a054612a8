// SPDX-License-Identifier: Apache-2.0
// The inner loops of queries at points, compiled once per instruction set (kernels_*.cpp) and chosen at run time. All
// sets give the same bits.
#pragma once

#include "field/cpu/kernels.h"
#include "points/cpu/point_group.h"
#include "standoff/execution.h"

namespace standoff::cpu {

struct PointKernels {
  /// Sets up the frames of node `number` of level 0. `center`: the origin of the boxes' coordinates, grid units;
  /// `scale`: grid units per world unit.
  void (*make_frames)(const BvhView&, std::uint32_t number, double scale, const double (&center)[3], NodeFrames&);
  /// Compares all points of the group with candidate triangles, and updates nearest_sq and nearest. Candidates are
  /// entries; those of a node of level 0 follow each other and ascend.
  void (*look_at)(const BvhView&, const std::uint32_t* candidates, std::int64_t count, PointGroup&, PointTable&);
  /// Searches all triangles for each point by itself.
  void (*look_at_all)(const BvhView&, PointGroup&, PairTable&);
  /// Finds the closest point of each triangle, and the feature that it is on. It measures as
  /// geometry/triangle_distance.h does: so the distance has the bits that made the triangle the nearest.
  void (*closest)(ClosestOfEight&);
  /// Adds up the solid angles of all triangles. `use`: how often each one counts, -1 to 1; null: all once.
  void (*add_solid_angles)(const BvhView&, const std::int8_t* use, SolidAngles&);
  /// The same as overlapping() in bvh/boxes16.h.
  std::uint32_t (*overlapping)(const Boxes16&, const FloatBox&);

  static const PointKernels portable, avx2, avx512;  ///< defined in kernels_<set>.cpp
};

}  // namespace standoff::cpu
