// SPDX-License-Identifier: Apache-2.0
// Which corner, side or face of a triangle is closest to a point.
#pragma once

#include <array>
#include <limits>

#include "standoff/vec.h"

namespace standoff {

struct ClosestFeature {
  enum class Kind { corner, side, face } kind;
  int n;      ///< the corner, or the side from this corner to the next one
  Vec3 away;  ///< from the closest point to the point asked about
};

/// In double. Requires finite corners. The face is taken only where the point is above it; of a triangle without area
/// a side or a corner is closest.
inline ClosestFeature closest_feature(const std::array<Vec3, 3>& corners, const Vec3& p) {
  using Kind = ClosestFeature::Kind;
  const std::array<Vec3, 3> to = {corners[0] - p, corners[1] - p, corners[2] - p};
  const Vec3 normal = cross(to[1] - to[0], to[2] - to[0]);
  const double normal_sq = dot(normal, normal);
  if (normal_sq > 0 && dot(normal, cross(to[0], to[1])) > 0 && dot(normal, cross(to[1], to[2])) > 0 &&
      dot(normal, cross(to[2], to[0])) > 0)
    return {Kind::face, 0, normal * (-dot(normal, to[0]) / normal_sq)};

  ClosestFeature best{Kind::corner, 0, {}};
  double best_sq = std::numeric_limits<double>::infinity();
  const auto look = [&](Kind kind, int n, const Vec3& at) {
    const double sq = dot(at, at);
    if (!(sq < best_sq)) return;
    best_sq = sq;
    best = {kind, n, at * -1.0};
  };
  for (int n = 0; n < 3; ++n) {
    const Vec3 &a = to[static_cast<std::size_t>(n)], &b = to[static_cast<std::size_t>((n + 1) % 3)], side = b - a;
    const double along = -dot(a, side), length_sq = dot(side, side);
    look(Kind::corner, n, a);
    if (along > 0 && along < length_sq) look(Kind::side, n, a + side * (along / length_sq));
  }
  return best;
}

}  // namespace standoff
