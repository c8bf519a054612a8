// SPDX-License-Identifier: Apache-2.0
// The independent check: does a segment intersect a surface? Triangles in the cells of a uniform grid, each tested
// exactly. It shares nothing with the queries but the exact test of two triangles.
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/triangle_pair.h"
#include "standoff/mesh.h"
#include "standoff/pose.h"

namespace standoff::fly {

class CrossingCheck {
 public:
  /// The mesh at a pose in the world.
  CrossingCheck(MeshView mesh, const Pose& pose);
  /// The segment and the surface have a point in common.
  bool crosses(Vec3 from, Vec3 to) const;

 private:
  struct Range {
    std::int64_t begin[3], end[3];
  };
  Range cells(const Box& box) const;

  std::vector<Corners> triangles_;
  std::vector<Box> boxes_;
  Box box_;
  double cell_ = 1;
  std::int64_t size_[3] = {1, 1, 1};
  std::vector<std::uint32_t> first_, members_;  // of cell n: members_[first_[n]] to members_[first_[n + 1]]
};

/// Corners of the mesh that stick out farthest in directions all around, and the middle of its box: the points whose
/// paths are checked.
std::vector<Vec3> outermost_points(MeshView mesh);

}  // namespace standoff::fly
