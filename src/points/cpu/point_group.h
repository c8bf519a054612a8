// SPDX-License-Identifier: Apache-2.0
// Points that are near each other, as the kernels answer them together.
#pragma once

#include <cstdint>

#include "field/cpu/frame_lanes.h"
#include "field/cpu/lattice.h"

namespace standoff::cpu {

/// The corners of a triangle, world units.
struct TriangleCorners {
  double at[3][3];
};

/// Lengths are in grid units of the index's lattice. Lanes left over repeat the last point.
struct PointGroup {
  static constexpr int kVectors = 4, kMost = kVectors * kLanes;

  int count;                          ///< 1 to kMost
  double scale;                       ///< grid units per world unit, a power of two
  double center[4];                   ///< the middle of their box, grid units; the fourth is zero
  float half[3];                      ///< half of their box, rounded up
  alignas(64) float local[3][kMost];  ///< relative to the center; axis, point
  alignas(64) float upper_sq[kMost];  ///< what the squared distance is at most
  double world[kMost][3];             ///< world units
  double nearest_sq[kMost];           ///< squared distance in double, grid units; infinite before
  std::uint32_t nearest[kMost];       ///< its triangle
};

/// Candidates of a group: entries of the index that are triangles.
struct PointCandidates {
  const std::uint32_t* entries;
  std::int64_t count;
  const TriangleCorners* corners;  ///< by entry
  const std::uint32_t* index;      ///< in the mesh, by entry
};

/// Scratch memory. More candidates than fit come one table after the other.
struct PointTable {
  static constexpr int kGroups = 16, kMost = kGroups * kLanes;
  static constexpr int kCorners = 8;

  struct Group {
    FrameLanes frame;
    alignas(64) float slack_sq[kLanes];             ///< what a squared distance may be off by, beside its share
    alignas(64) float corner_sq[kCorners][kLanes];  ///< from the corners of the points' box, at least
  };
  struct Pair {
    std::uint32_t entry;
    std::uint32_t point;
  };
  Group groups[kGroups];
  std::uint16_t kept[kMost + kLanes];                    ///< group * kLanes + lane
  alignas(64) float lower_sq[kMost][PointGroup::kMost];  ///< by kept candidate: squared distances at least
  Pair pairs[kMost * PointGroup::kMost];                 ///< whose distance is taken in double
};

}  // namespace standoff::cpu
