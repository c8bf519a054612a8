// SPDX-License-Identifier: Apache-2.0
// Points that are near each other, as the kernels answer them together.
#pragma once

#include <cstdint>

#include "field/cpu/kernels.h"

namespace standoff::cpu {

/// Sixteen triangles of a node set up as frames, relative to a point amid them. Grid units.
struct NodeFrames {
  FrameLanes frame;
  double center[3];  ///< relative to the middle of the index
  float extent;      ///< no coordinate of a corner relative to the center is larger
};

/// The hierarchy as the kernels see it. Pack k of level l holds the nodes 16 (k - begin[l]) + begin[l - 1] and up to 15
/// after it, or, of level 0, triangles 16 k and up to 15 after it, by their place in the order.
struct BvhView {
  static constexpr int kMostLevels = Bvh::kMostLevels;

  const Boxes16* boxes;          ///< of the nodes
  const NodeFrames* frames;      ///< of the nodes of level 0
  const std::uint32_t* index;    ///< in the mesh, of each triangle by its place
  const double* vertices;        ///< three numbers each, world units
  const std::uint32_t* corners;  ///< three vertices of each triangle of the mesh
  std::uint32_t triangles;
  int top;  ///< the highest level, which has one node
  std::uint32_t begin[kMostLevels + 1];
};

/// Lengths are in grid units of the index's lattice. Lanes left over repeat the last point.
struct PointGroup {
  static constexpr int kVectors = 4, kMost = kVectors * kLanes;

  int count;                          ///< 1 to kMost
  double scale;                       ///< grid units per world unit, a power of two
  double center[4];                   ///< amid them, grid units; the fourth is zero
  double middle[3];                   ///< the same relative to the middle of the index
  float half[3];                      ///< half of their box, rounded up
  alignas(64) float local[3][kMost];  ///< relative to the center; axis, point
  alignas(64) float upper_sq[kMost];  ///< what the squared distance is at most
  alignas(32) double at[kMost][4];    ///< grid units; the fourth is zero
  double nearest_sq[kMost];           ///< squared distance in double, grid units; infinite before
  std::uint32_t nearest[kMost];       ///< its triangle
  std::uint32_t start = 0;            ///< a node of level 0 near which to begin
};

/// Scratch memory for triangles whose distances are to be taken in double.
struct PairTable {
  static constexpr int kMostPairs = 1024, kMostNear = 1024;

  /// A triangle, by its place in the order, whose distance from a point is taken in double.
  struct Pair {
    std::uint32_t place;
    std::uint32_t point;
  };
  Pair pairs[kMostPairs];
  int pair_count;
  /// A triangle that may be the nearest of one point.
  struct Near {
    std::uint32_t place;
    float lower_sq;
  };
  Near near[kMostNear];
};

/// The same for a group that has candidates in common.
struct PointTable : PairTable {
  static constexpr int kNodes = 64, kCorners = 8, kMostKept = 256;

  /// A node of level 0 of which some triangles are candidates.
  struct Node {
    std::uint32_t number;
    std::uint32_t lanes;  ///< bits of the candidates
    float offset[3];      ///< the group's center relative to the frames'
    float slack_share;    ///< what a squared distance may be off by, as a share of it
    float slack_sq;       ///< and beside that
  };
  Node nodes[kNodes];
  alignas(64) float corner_sq[kNodes][kCorners][kLanes];     ///< from the corners of the points' box, at least
  std::uint16_t kept[kNodes * kLanes];                       ///< node * kLanes + lane
  alignas(64) float lower_sq[kMostKept][PointGroup::kMost];  ///< squared distances at least, by kept candidate
};

/// Eight points, and of each the point that is nearest to it of one triangle. Lengths are in any unit, relative to the
/// points.
struct ClosestOfEight {
  static constexpr int kCount = 8;

  alignas(64) double corners[3][3][kCount];  ///< given: corner, axis, point
  alignas(64) double point[3][kCount];       ///< found: axis, point
  alignas(64) double weights[3][kCount];     ///< its barycentric coordinates, by corner
  alignas(64) double feature[kCount];        ///< a number of standoff::Feature
};

/// The solid angles of all triangles at a point, over 4 pi: in eight parts, each `around` and the argument of re + i im
/// in full turns; and a half for each flat triangle, towards the side of its plane that the point is on.
struct SolidAngles {
  static constexpr int kCount = 8, kMostFlat = 64;
  /// Angles are certain within 1e-9 where x^2 + y^2 of a triangle is above. The point then is away from its edges.
  static constexpr double kLeastSq = 1e-12;
  /// Rounding may hide on which side of a triangle a point is where y is below.
  static constexpr double kFlat = 1e-13;

  double scale;              ///< given: units per world unit, a power of two
  alignas(32) double at[4];  ///< given: the point, in such units; the fourth is zero
  bool is_certain;           ///< found: else the rest is not
  alignas(64) double re[kCount], im[kCount], around[kCount];
  std::uint32_t flat[kMostFlat];  ///< triangles in the mesh that the point is on within rounding
  int flat_count;
};

}  // namespace standoff::cpu
