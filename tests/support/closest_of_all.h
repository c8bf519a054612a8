// SPDX-License-Identifier: Apache-2.0
// The distance field by definition, for tests: every triangle, in double precision.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

#include "geometry/triangle_distance.h"
#include "standoff/mesh.h"

namespace standoff::testing {

/// The distance from p to one triangle. Corners are taken relative to p, so that places far from the origin lose
/// nothing.
inline double triangle_distance(MeshView mesh, std::size_t triangle, Vec3 p) {
  const auto corner = [&](int k) {
    const Vec3 v = mesh.corner(triangle, k) - p;
    return Triple<double>{v.x, v.y, v.z};
  };
  return std::sqrt(origin_distance_sq(corner(0), corner(1), corner(2)));
}

/// The distance from p to the mesh.
inline double brute_distance(MeshView mesh, Vec3 p) {
  double distance = std::numeric_limits<double>::infinity();
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) distance = std::min(distance, triangle_distance(mesh, t, p));
  return distance;
}

}  // namespace standoff::testing
