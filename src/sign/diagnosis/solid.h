// SPDX-License-Identifier: Apache-2.0
// Which parts of a mesh have an inside: they are turned outwards, and may contain others.
#pragma once

#include <cmath>

#include "standoff/vec.h"

namespace standoff {

/// A part has no volume if |volume| is at most this times area^1.5. For a ball that ratio is 0.094, for a wire a
/// million times as long as thick 2e-4. What rounding makes of a flat part is far below.
inline constexpr double kNoVolume = 1e-10;
/// An open part is a sheet if the sum of its normals, each as long as its triangle's area, is at least this part of its
/// area. 0: closed, or with the same holes on opposite sides; 0.2: a cube without lid; 0.5: a hemisphere; 1: flat. A
/// sheet is not turned: a hemisphere may be a dome or a bowl.
inline constexpr double kSheetNormals = 0.25;

/// Sums over the triangles of a part that is oriented consistently. The volume is relative to a point near it, which
/// matters only if it is open.
struct PartSums {
  double volume = 0, area = 0;
  Vec3 normals;

  /// `relative_to` is the point for the volume.
  void add(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& relative_to) {
    const Vec3 normal = cross(b - a, c - a) * 0.5;
    volume += dot(a - relative_to, normal) / 3;
    area += length(normal);
    normals = normals + normal;
  }
  /// All of another part, turned if `turn` is -1.
  void add(const PartSums& other, int turn) {
    volume += turn * other.volume;
    area += other.area;
    normals = normals + other.normals * turn;
  }
};

inline bool is_solid(const PartSums& sums, bool closed) {
  if (!closed && !(length(sums.normals) < kSheetNormals * sums.area)) return false;
  return std::abs(sums.volume) > kNoVolume * sums.area * std::sqrt(sums.area);
}

}  // namespace standoff
