// SPDX-License-Identifier: Apache-2.0
// Placements of nodes, in double precision, and triangles where they place them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "standoff/vec.h"
#include "tests/grammar/file.h"

namespace standoff::grammar {

/// Three rows of a matrix for column vectors.
using Rows = std::array<std::array<double, 4>, 3>;
inline constexpr Rows kUnmoved{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};

inline Rows product(const Rows& outer, const Rows& inner) {
  Rows m{};
  for (std::size_t r = 0; r < 3; ++r)
    for (std::size_t k = 0; k < 4; ++k) {
      m[r][k] = k == 3 ? outer[r][3] : 0;
      for (std::size_t j = 0; j < 3; ++j) m[r][k] += outer[r][j] * inner[j][k];
    }
  return m;
}

class Transform {
 public:
  Transform(const Rows& rows = kUnmoved) : rows_(rows), sizes_(rows) {
    for (auto& row : sizes_)
      for (double& value : row) value = std::abs(value);
  }

  Vec3 operator()(const Vec3& p) const {
    const auto row = [&](const std::array<double, 4>& r) { return r[0] * p.x + r[1] * p.y + r[2] * p.z + r[3]; };
    return {row(rows_[0]), row(rows_[1]), row(rows_[2])};
  }
  /// It turns triangles inside out.
  bool mirrors() const {
    const auto& [a, b, c] = rows_;
    return a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) +
               a[2] * (b[0] * c[1] - b[1] * c[0]) <
           0;
  }
  /// This one after the other.
  Transform after(const Transform& inner) const {
    Transform both(product(rows_, inner.rows_));
    both.sizes_ = product(sizes_, inner.sizes_);
    return both;
  }
  /// How far off a reader may put points of coordinates up to `most` that are off by `slack` themselves: float rounds
  /// every number on the way, also where large ones cancel in the end.
  double slack(double most, double slack = 0) const {
    constexpr double kRounding = 4e-6;  // some dozens of roundings of 6e-8
    double largest = 0;
    for (const auto& r : sizes_) {
      const double growth = r[0] + r[1] + r[2];
      largest = std::max(largest, kRounding * (growth * most + r[3]) + growth * slack);
    }
    return largest;
  }

 private:
  Rows rows_, sizes_;
};

inline Transform translation(const Vec3& by) { return Rows{{{1, 0, 0, by.x}, {0, 1, 0, by.y}, {0, 0, 1, by.z}}}; }
inline Transform scaling(const Vec3& by) { return Rows{{{by.x, 0, 0, 0}, {0, by.y, 0, 0}, {0, 0, by.z, 0}}}; }

/// A unit quaternion, as glTF has it.
inline Transform rotation(double x, double y, double z, double w) {
  return Rows{{{1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w), 0},
               {2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w), 0},
               {2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y), 0}}};
}

/// About an axis of length one.
inline Transform rotation_about(const Vec3& axis, double angle_rad) {
  const double s = std::sin(angle_rad / 2);
  return rotation(axis.x * s, axis.y * s, axis.z * s, std::cos(angle_rad / 2));
}

enum class Mirrored {
  as_it_is,     ///< what a mirror turns inside out stays so
  turned_back,  ///< its corners go the other way round
};

/// Adds the triangles of `part` at their place.
inline void add_placed(const Truth& part, const Transform& to, Mirrored mirrored, Truth& all) {
  double most = 0, slack = 0;
  for (const Corners& corners : part.triangles)
    for (const Vec3& p : corners) most = std::max({most, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  for (const double s : part.slack) slack = std::max(slack, s);
  const std::size_t second = mirrored == Mirrored::turned_back && to.mirrors() ? 2 : 1;
  for (const Corners& corners : part.triangles)
    all.triangles.push_back({to(corners[0]), to(corners[second]), to(corners[3 - second])});
  all.slack.resize(all.triangles.size(), to.slack(most, slack));
}

}  // namespace standoff::grammar
