// SPDX-License-Identifier: Apache-2.0
// Polygons into triangles.
#pragma once

#include <span>

#include "standoff/mesh.h"

namespace standoff {

/// Squares of corners that a mesh with so many corners in its polygons may take: what one polygon of 2^15 corners
/// needs, a few seconds, and 256 for each corner, which real polygons do not come near.
inline double polygon_work(std::size_t corners) { return 0x1p30 + 256 * static_cast<double>(corners); }

/// Triangulates the polygon whose corners are fan[0][0], fan[0][1] and fan[k][2], in order, and replaces the fan: n
/// corners always give n - 2 triangles over the same corners. The polygon is looked at along the axis that its normal
/// (Newell's sum) is closest to. Where no triangle of the fan turns against the normal, as in every convex polygon, the
/// fan stays. Otherwise ears are cut, in the order of the corners; polygons that cross themselves are cut where no ear
/// is left, at the first convex corner. Polygons that are not planar or have no area get some triangulation, always
/// the same one. Cutting ears takes time by the square of the corners, and `work` bounds it: so many squares
/// are taken off it. Returns false, with all unchanged, when the polygon is not convex and has more squares than are
/// left. Requires finite corners.
bool triangulate(std::span<const Vec3> vertices, std::span<Triangle> fan, double& work);

}  // namespace standoff
