// SPDX-License-Identifier: Apache-2.0
// The generalised winding number by its definition, in double.
#pragma once

#include <cmath>
#include <numbers>

#include "standoff/mesh.h"

namespace standoff::testing {

/// The generalised winding number: solid angles (van Oosterom and Strackee 1983) summed over all triangles as they are
/// oriented, in double.
inline double winding_number(MeshView mesh, Vec3 p) {
  double sum = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto [a, b, c] = mesh.corners(t);
    const Vec3 u = a - p, v = b - p, w = c - p;
    const double lu = length(u), lv = length(v), lw = length(w);
    const double volume = dot(u, cross(v, w));
    // A point in the plane of the triangle sees no angle of it; atan2 would take -0 for the other side of it.
    if (volume != 0) sum += std::atan2(volume, lu * lv * lw + dot(u, v) * lw + dot(v, w) * lu + dot(w, u) * lv);
  }
  return sum / (2 * std::numbers::pi);
}

}  // namespace standoff::testing
