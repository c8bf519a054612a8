// SPDX-License-Identifier: Apache-2.0
// The generalised winding number as it is defined: the solid angles of all triangles, one by one, in double.
#pragma once

#include <array>
#include <cmath>
#include <numbers>

#include "standoff/mesh.h"

namespace standoff::testing {

struct BruteWinding {
  double value = 0;
  bool on_surface = false;  ///< the point is on a triangle within rounding: the value may be any of those around it
};

inline BruteWinding brute_winding(const Mesh& mesh, const Vec3& p) {
  BruteWinding winding;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    std::array<Vec3, 3> d = MeshView(mesh).corners(t);
    for (Vec3& corner : d) {
      corner = corner - p;
      const double l = length(corner);
      winding.on_surface |= l == 0;
      corner = corner * (1 / l);
    }
    // Van Oosterom and Strackee 1983.
    const double y = dot(d[0], cross(d[1], d[2])), x = 1 + dot(d[0], d[1]) + dot(d[1], d[2]) + dot(d[2], d[0]);
    winding.value += std::atan2(y, x) / (2 * std::numbers::pi);
    winding.on_surface |= (x < 0 && std::abs(y) < 1e-12) || std::hypot(x, y) < 1e-7;
  }
  return winding;
}

}  // namespace standoff::testing
