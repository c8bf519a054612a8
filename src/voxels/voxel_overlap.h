// SPDX-License-Identifier: Apache-2.0
// Whether a triangle and an axis-aligned box have a point in common: by separating axes (Akenine-Moeller, Fast 3D
// triangle-box overlap testing, 2001).
//
// Whatever axis is tried, boxes that it separates are apart, so the axes themselves may be rounded. Projections are off
// by less than 8 u times the sum of |axis| times the magnitudes that are multiplied with it. An axis counts only beyond
// kSlack times that sum: so no overlap is missed.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "standoff/vec.h"

namespace standoff {

class TriangleInVoxels {
 public:
  /// `half`: half of the voxels' sides.
  TriangleInVoxels(const std::array<Vec3, 3>& corners, const Vec3& half)
      : t_(corners),
        half_(half),
        edges_{t_[1] - t_[0], t_[2] - t_[1], t_[0] - t_[2]},
        normal_(cross(edges_[0], edges_[1])) {}

  const Vec3& normal() const { return normal_; }
  /// Whether rounding leaves the normal most of its digits.
  bool normal_is_good() const { return length(normal_) > 1e-4 * max_norm(edges_[0]) * max_norm(edges_[1]); }

  /// True for all voxels that overlap, and for those that rounding does not tell from them.
  bool overlaps(const Vec3& center) const {
    const Vec3 v[3] = {t_[0] - center, t_[1] - center, t_[2] - center};
    const auto most = [&](double a, double b, double c) { return std::max({std::abs(a), std::abs(b), std::abs(c)}); };
    const Vec3 reach{most(v[0].x, v[1].x, v[2].x) + half_.x, most(v[0].y, v[1].y, v[2].y) + half_.y,
                     most(v[0].z, v[1].z, v[2].z) + half_.z};
    const auto apart = [&](const Vec3& axis) {
      const Vec3 size{std::abs(axis.x), std::abs(axis.y), std::abs(axis.z)};
      const auto [low, high] = std::minmax({dot(axis, v[0]), dot(axis, v[1]), dot(axis, v[2])});
      const double bound = dot(size, half_) + kSlack * dot(size, reach);
      return low > bound || high < -bound;
    };
    if (apart({1, 0, 0}) || apart({0, 1, 0}) || apart({0, 0, 1}) || apart(normal_)) return false;
    for (const Vec3& e : edges_)
      if (apart({0, -e.z, e.y}) || apart({e.z, 0, -e.x}) || apart({-e.y, e.x, 0})) return false;
    return true;
  }

 private:
  static constexpr double kSlack = 1e-14;

  std::array<Vec3, 3> t_;
  Vec3 half_;
  std::array<Vec3, 3> edges_;
  Vec3 normal_;
};

}  // namespace standoff
