// SPDX-License-Identifier: Apache-2.0
// Closest points: the point of a mesh nearest to each given point (docs/points.md).
//
// The interface is final. The search is the one that verify() uses: it is exact, and fast enough for thousands of
// points, but not for millions. For many points close together, a field (standoff/compute.h) is faster.
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

/// The point of a mesh's surface that is nearest to a query point. A sign may be added in a later version.
struct ClosestPoint {
  double distance = std::numeric_limits<double>::infinity();  ///< from the query point to `point`, world units
  Vec3 point;                                                 ///< on the surface
  std::uint32_t triangle = kNoTriangle;  ///< the triangle that contains `point`; the lowest index on ties
  /// Barycentric coordinates of `point`, in the order of the triangle's corners; each from 0 to 1, with sum 1 up to
  /// rounding.
  std::array<double, 3> weights = {};
};

/// The closest point for each of `points`, in this order. The result has the same bits for any number of threads. All
/// arithmetic is in double precision; the error of the distance is a few 1e-16 of the extent of point and triangle
/// together. Runs on the CPU. The time is proportional to points * (triangles / 32).
/// Errors: input (mesh), usage (execution; a point that is not finite), limit (a coordinate of mesh or points beyond
/// kMaxCoordinate; memory).
STANDOFF_API std::vector<ClosestPoint> closest_points(MeshView mesh, std::span<const Vec3> points,
                                                      const Execution& execution = {});

}  // namespace standoff
