// Polygons into triangles.
#pragma once

#include <span>

#include "difi/mesh.h"

namespace difi {

/// The most corners of a polygon that is not convex: cutting its ears takes quadratic time.
inline constexpr std::size_t kMaxConcaveCorners = std::size_t{1} << 15;

/// Triangulates the polygon whose corners are fan[0][0], fan[0][1] and fan[k][2], in order, and replaces the fan: n
/// corners always give n - 2 triangles over the same corners. The polygon is looked at along the axis that its normal
/// (Newell's sum) is closest to. Where no triangle of the fan turns against the normal, as in every convex polygon, the
/// fan stays. Otherwise ears are cut, in the order of the corners; polygons that cross themselves are cut where no ear
/// is left, at the first convex corner. Polygons that are not planar or have no area get some triangulation, always
/// the same one. Returns false, with the fan unchanged, when the polygon is not convex and has too many corners.
/// Requires finite corners.
bool triangulate(std::span<const Vec3> vertices, std::span<Triangle> fan);

}  // namespace difi
