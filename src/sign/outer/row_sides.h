// SPDX-License-Identifier: Apache-2.0
// What is on the two sides of a triangle where a row, a line along an axis, passes through it.
#pragma once

#include <optional>

#include "bvh/bvh.h"
#include "geometry/predicates.h"
#include "sign/oriented_mesh.h"
#include "standoff/sign.h"

namespace standoff {

/// A line along an axis: 0 to 2 for x to z, at (y, z), (z, x) or (x, y).
struct Row {
  int axis;
  Flat at;
};

/// The winding numbers just before and just behind a triangle along a row.
struct TwoSides {
  int before, behind;
};

/// Counts the crossings of rows exactly, as ray_crossing.h does. Where they are along the row is rounded, with a bound:
/// what may be on either side of the triangle must be in its plane, such as a wall that two boxes have in common.
/// Triangles of one plane are passed together.
class RowSides {
 public:
  /// The mesh and the BVH must outlive this. Requires a closed mesh.
  RowSides(const OrientedMesh& mesh, const Bvh& bvh);

  /// Nothing where the row misses the triangle, or rounding hides what lies next to it.
  std::optional<TwoSides> of(std::uint32_t triangle, const Row& row) const;

 private:
  OrientedMesh mesh_;
  const Bvh& bvh_;
  Box bounds_;
};

}  // namespace standoff
