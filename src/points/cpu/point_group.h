// SPDX-License-Identifier: Apache-2.0
// The data of the kernels of queries at points.
#pragma once

#include <cstdint>

#include "field/cpu/kernels.h"

namespace standoff::cpu {

/// The frames of a node's sixteen triangles, relative to a point amid them. Grid units.
struct NodeFrames {
  FrameLanes frame;
  double center[3];  ///< relative to the middle of the index
  float extent;      ///< the largest coordinate of a corner relative to the center, in magnitude
};

/// The BVH as the kernels see it. Node k of level l > 0 has as children the nodes from 16 (k - begin[l]) + begin[l - 1]
/// on, node k of level 0 the triangles of the entries from 16 k on: sixteen of them, or the rest of the level
/// below.
struct BvhView {
  static constexpr int kMostLevels = Bvh::kMostLevels;

  const Boxes16* boxes;          ///< of the nodes
  const NodeFrames* frames;      ///< of the nodes of level 0
  const std::uint32_t* index;    ///< the triangle of each entry
  const double* vertices;        ///< three coordinates each, world units
  const std::uint32_t* corners;  ///< the three vertices of each triangle of the mesh
  std::uint32_t triangles;
  int top;  ///< the highest level, which has one node
  std::uint32_t begin[kMostLevels + 1];
};

/// Points that are near each other, and their answers so far. Lengths are in grid units of the index's lattice. Lanes
/// left over repeat the last point.
struct PointGroup {
  static constexpr int kVectors = 4, kMost = kVectors * kLanes;

  int count;                          ///< 1 to kMost
  double scale;                       ///< grid units per world unit, a power of two
  double center[4];                   ///< the center of their box, grid units; the fourth number is zero
  double middle[3];                   ///< the center relative to the middle of the index
  float half[3];                      ///< half of their box, rounded up
  alignas(64) float local[3][kMost];  ///< relative to the center; axis, point
  alignas(64) float upper_sq[kMost];  ///< upper bounds of the squared distances
  alignas(32) double at[kMost][4];    ///< the points, grid units; the fourth number is zero
  double nearest_sq[kMost];           ///< squared distance in double, grid units; infinite before
  std::uint32_t nearest[kMost];       ///< the triangle at this distance
  std::uint32_t start = 0;            ///< the node of level 0 where the next search begins
};

/// Scratch memory: pairs of a point and a triangle whose distance must be measured in double.
struct PairTable {
  static constexpr int kMostPairs = 1024, kMostNear = 1024;

  struct Pair {
    std::uint32_t place;  ///< entry of the triangle
    std::uint32_t point;
  };
  Pair pairs[kMostPairs];
  int pair_count;
  /// A triangle that may be the nearest of one point.
  struct Near {
    std::uint32_t place;
    float lower_sq;  ///< lower bound of the squared distance
  };
  Near near[kMostNear];
};

/// Scratch memory for a group of points that share candidates.
struct PointTable : PairTable {
  static constexpr int kNodes = 64, kCorners = 8, kMostKept = 256;

  /// A node of level 0 with candidates among its triangles.
  struct Node {
    std::uint32_t number;
    std::uint32_t lanes;  ///< bits of the candidates
    float offset[3];      ///< the group's center relative to the frames'
    float slack_share;    ///< the error of a squared distance: at most this share of it
    float slack_sq;       ///< plus this
  };
  Node nodes[kNodes];
  alignas(64) float corner_sq[kNodes][kCorners][kLanes];     ///< lower bounds from the corners of the points' box
  std::uint16_t kept[kNodes * kLanes];                       ///< node * kLanes + lane
  alignas(64) float lower_sq[kMostKept][PointGroup::kMost];  ///< lower bounds from the points, by kept candidate
};

/// Eight points with a triangle each, and the closest point of each triangle. Coordinates are relative to the point, in
/// any unit.
struct ClosestOfEight {
  static constexpr int kCount = 8;

  alignas(64) double corners[3][3][kCount];  ///< given: corner, axis, point
  alignas(64) double point[3][kCount];       ///< found: axis, point
  alignas(64) double weights[3][kCount];     ///< its barycentric coordinates, by corner
  alignas(64) double feature[kCount];        ///< a number of standoff::Feature
};

/// The sum of the solid angles of all triangles at a point, over 4 pi. It has eight parts, each `around` plus the
/// argument of re + i im in full turns. Flat triangles come on top: each counts 1/2 or -1/2, by the side of its plane
/// that the point is on.
struct SolidAngles {
  static constexpr int kCount = 8, kMostFlat = 64;
  /// If x^2 + y^2 of a triangle is above this, the point is away from its edges, and the angle is certain within 1e-9.
  static constexpr double kLeastSq = 1e-12;
  /// If |y| of a triangle is below this, rounding may hide on which side of its plane the point is.
  static constexpr double kFlat = 1e-13;

  double scale;              ///< given: units per world unit, a power of two
  alignas(32) double at[4];  ///< given: the point, in these units; the fourth number is zero
  bool is_certain;           ///< found: if false, so is the rest
  alignas(64) double re[kCount], im[kCount], around[kCount];
  std::uint32_t flat[kMostFlat];  ///< the triangles that the point lies on within rounding
  int flat_count;
};

}  // namespace standoff::cpu
