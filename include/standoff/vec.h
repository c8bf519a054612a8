// SPDX-License-Identifier: Apache-2.0
// Value types of the public API: points, integer extents and boxes.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace standoff {

/// Squares of distances between points are finite if no coordinate is larger than this in magnitude. World units.
inline constexpr double kMaxCoordinate = 1e150;

/// A point or vector in world units.
struct Vec3 {
  double x = 0, y = 0, z = 0;

  /// The component along axis 0, 1 or 2.
  constexpr double& operator[](std::size_t axis) { return axis == 0 ? x : axis == 1 ? y : z; }
  constexpr double operator[](std::size_t axis) const { return axis == 0 ? x : axis == 1 ? y : z; }

  friend constexpr bool operator==(const Vec3&, const Vec3&) = default;
  friend constexpr Vec3 operator-(Vec3 a) { return {-a.x, -a.y, -a.z}; }
  friend constexpr Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend constexpr Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend constexpr Vec3 operator*(Vec3 a, double s) { return {a.x * s, a.y * s, a.z * s}; }
  friend constexpr Vec3 operator*(double s, Vec3 a) { return a * s; }
  /// Component-wise product.
  friend constexpr Vec3 operator*(Vec3 a, Vec3 b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
  /// Component-wise quotient.
  friend constexpr Vec3 operator/(Vec3 a, Vec3 b) { return {a.x / b.x, a.y / b.y, a.z / b.z}; }
};

constexpr double dot(Vec3 a, Vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
constexpr Vec3 cross(Vec3 a, Vec3 b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
constexpr Vec3 min(Vec3 a, Vec3 b) { return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)}; }
constexpr Vec3 max(Vec3 a, Vec3 b) { return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)}; }
inline double length(Vec3 a) { return std::sqrt(dot(a, a)); }
/// The largest of |x|, |y| and |z|.
inline double max_norm(Vec3 a) { return std::max({std::abs(a.x), std::abs(a.y), std::abs(a.z)}); }
inline bool is_finite(Vec3 a) { return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z); }

/// Counts along the three axes. All counts have 64 bits, because grids may have more than 2^31 samples.
struct Size3 {
  std::int64_t x = 0, y = 0, z = 0;

  /// The count along axis 0, 1 or 2.
  constexpr std::int64_t& operator[](std::size_t axis) { return axis == 0 ? x : axis == 1 ? y : z; }
  constexpr std::int64_t operator[](std::size_t axis) const { return axis == 0 ? x : axis == 1 ? y : z; }

  friend constexpr bool operator==(const Size3&, const Size3&) = default;
  /// The product; 0 if a count is not positive, and the largest std::int64_t if the product exceeds it.
  constexpr std::int64_t count() const {
    constexpr std::int64_t most = std::numeric_limits<std::int64_t>::max();
    if (x <= 0 || y <= 0 || z <= 0) return 0;
    if (x > most / y || x * y > most / z) return most;
    return x * y * z;
  }
};

/// An axis-aligned box. It is empty if min exceeds max on some axis; a new box is empty.
struct Box {
  Vec3 min = Vec3{1, 1, 1} * std::numeric_limits<double>::infinity();
  Vec3 max = Vec3{1, 1, 1} * -std::numeric_limits<double>::infinity();

  constexpr bool empty() const { return !(min.x <= max.x && min.y <= max.y && min.z <= max.z); }
  constexpr Vec3 extent() const { return max - min; }
  constexpr double longest_side() const {
    const Vec3 e = extent();
    return std::max({e.x, e.y, e.z});
  }
  constexpr Vec3 center() const { return (min + max) * 0.5; }
  constexpr void include(Vec3 p) {
    min = standoff::min(min, p);
    max = standoff::max(max, p);
  }
  constexpr Box grown(double margin) const {
    const Vec3 m{margin, margin, margin};
    return {min - m, max + m};
  }
};

}  // namespace standoff
