// SPDX-License-Identifier: Apache-2.0
// The points of a mesh nearest to any points.
//
// This is the interface that stays. Behind it now is the search that verify() tests fields with: exact, and made for
// thousands of points, not for millions. For many points near each other a field (standoff/compute.h) is faster.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "standoff/execution.h"
#include "standoff/export.h"
#include "standoff/mesh.h"
#include "standoff/vec.h"

namespace standoff {

/// The point of a mesh's surface that is nearest to a point. Room is left for its sign.
struct ClosestPoint {
  double distance = std::numeric_limits<double>::infinity();  ///< world units, from the point asked about to `point`
  Vec3 point;                                                 ///< on the surface
  std::uint32_t triangle = kNoTriangle;  ///< that holds it; of equally near ones the one of lowest index
  /// Barycentric coordinates of `point`: of the triangle's three corners in order, from 0 to 1, their sum 1 but for
  /// rounding.
  std::array<double, 3> weights = {};
};

/// The closest point for each of `points`, in this order; the same bits for any number of threads. In double precision:
/// the distance errs by a few 1e-16 of the extent of point and triangle together. Runs on the CPU. Takes time in
/// proportion to points * (triangles / 32).
/// Errors: input (mesh), usage (execution; a point that is not finite), limit (mesh or points beyond 1e150; memory).
STANDOFF_API std::vector<ClosestPoint> closest_points(MeshView mesh, std::span<const Vec3> points,
                                                      const Execution& execution = {});

}  // namespace standoff
