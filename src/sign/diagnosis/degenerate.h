// SPDX-License-Identifier: Apache-2.0
// Triangles without area, exactly: they are no part of a surface.
#pragma once

#include "geometry/coplanar.h"
#include "standoff/mesh.h"

namespace standoff {

inline bool is_degenerate(const Corners& t) {
  const Vec3 u = t[1] - t[0], v = t[2] - t[0];
  // Rounding moves the normal by less than that.
  if (max_norm(cross(u, v)) > 1e-14 * max_norm(u) * max_norm(v)) return false;
  return normal_direction(t) == Vec3{};
}

}  // namespace standoff
