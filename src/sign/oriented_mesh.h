// SPDX-License-Identifier: Apache-2.0
// A mesh in the orientation that decides its sign, and the volume that its parts enclose. The caller's mesh is never
// changed.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <utility>

#include "standoff/mesh.h"
#include "standoff/vec.h"

namespace standoff {

struct OrientedMesh {
  MeshView mesh;
  /// The orientation of each triangle: 1 as it is, -1 reversed, 0 left out. Empty: all are used as they are.
  std::span<const std::int8_t> use = {};

  int use_of(std::size_t triangle) const { return use.empty() ? 1 : use[triangle]; }
  /// The corners in this orientation. Requires that the triangle is not left out.
  std::array<Vec3, 3> corners(std::size_t triangle) const {
    std::array<Vec3, 3> t = mesh.corners(triangle);
    if (use_of(triangle) < 0) std::swap(t[1], t[2]);
    return t;
  }
};

inline double area_of(const std::array<Vec3, 3>& t) { return length(cross(t[1] - t[0], t[2] - t[0])) / 2; }

/// A part has no volume if |volume| is at most this times area^1.5. The ratio is 0.094 for a ball, and 2e-4 for a wire
/// a million times as long as thick. Rounding leaves far less of a flat part.
inline constexpr double kNoVolume = 1e-10;
/// An open part is a sheet if the sum of its normals, each as long as its triangle's area, is at least this part of its
/// area: 0 if it is closed or has the same holes on opposite sides, 0.2 for a cube without a lid, 0.5 for a hemisphere,
/// 1 if it is flat. A sheet keeps its orientation, because a hemisphere may be a dome or a bowl.
inline constexpr double kSheetNormals = 0.25;

/// Sums over the triangles of a part that is oriented consistently. The volume is taken relative to a point near the
/// part, which matters only if the part is open.
struct PartSums {
  double volume = 0, area = 0;
  Vec3 normals;

  /// Adds a triangle; `relative_to` is the point that volumes are relative to.
  void add(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& relative_to) {
    const Vec3 normal = cross(b - a, c - a) * 0.5;
    volume += dot(a - relative_to, normal) / 3;
    area += length(normal);
    normals = normals + normal;
  }
  /// Adds another part in its orientation (1), or reversed (-1).
  void add(const PartSums& other, int orientation) {
    volume += orientation * other.volume;
    area += other.area;
    normals = normals + other.normals * orientation;
  }
};

/// Whether a part has an inside: then it is oriented outwards, and may contain other parts.
inline bool is_solid(const PartSums& sums, bool closed) {
  if (!closed && !(length(sums.normals) < kSheetNormals * sums.area)) return false;
  return std::abs(sums.volume) > kNoVolume * sums.area * std::sqrt(sums.area);
}

}  // namespace standoff
