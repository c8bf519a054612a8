// SPDX-License-Identifier: Apache-2.0
// Whether triangles may touch a cell.
#pragma once

#include <array>
#include <cmath>

#include "sign/open_winding/linear_field.h"
#include "sign/open_winding/rims.h"

namespace standoff {

/// False only if no point of the triangle is in the cell: its box, or its plane, is beside it. The cell is taken a
/// little larger than it is, by more than rounding.
inline bool may_touch(const std::array<Vec3, 3>& t, const Cell& cell) {
  const Vec3 a = t[0] - cell.center, b = t[1] - cell.center, c = t[2] - cell.center;
  const Vec3 low = min(a, min(b, c)), high = max(a, max(b, c));
  if (low.x > cell.half.x || low.y > cell.half.y || low.z > cell.half.z || high.x < -cell.half.x ||
      high.y < -cell.half.y || high.z < -cell.half.z)
    return false;
  const Vec3 normal = cross(b - a, c - a);
  const Vec3 size = {std::abs(normal.x), std::abs(normal.y), std::abs(normal.z)};
  const double rounding = 1e-14 * (dot(size, max(high, low * -1.0)));
  return std::abs(dot(normal, a)) <= dot(size, cell.half) + rounding;
}

/// The same for the cap of a rim.
inline bool may_touch(const Rim& rim, const Cell& cell) {
  const Vec3* corner = &rim.corners.back();
  for (const Vec3& next : rim.corners) {
    if (may_touch({rim.apex, *corner, next}, cell)) return true;
    corner = &next;
  }
  return false;
}

}  // namespace standoff
