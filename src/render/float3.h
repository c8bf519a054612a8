// SPDX-License-Identifier: Apache-2.0
// The single-precision vectors of the renderer.
#pragma once

#include <algorithm>
#include <cmath>

namespace standoff {

struct Float3 {
  float x = 0, y = 0, z = 0;

  friend constexpr Float3 operator+(Float3 a, Float3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend constexpr Float3 operator-(Float3 a, Float3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend constexpr Float3 operator*(Float3 a, float s) { return {a.x * s, a.y * s, a.z * s}; }
  /// Component-wise product.
  friend constexpr Float3 operator*(Float3 a, Float3 b) { return {a.x * b.x, a.y * b.y, a.z * b.z}; }
};

constexpr float dot(Float3 a, Float3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
constexpr Float3 cross(Float3 a, Float3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline float length(Float3 a) { return std::sqrt(dot(a, a)); }

/// The vector with length 1, or `otherwise` if it has none.
inline Float3 unit_or(Float3 a, Float3 otherwise) {
  // Scaled first: squares of small components would vanish.
  const float most = std::max({std::abs(a.x), std::abs(a.y), std::abs(a.z)});
  if (!(most > 0)) return otherwise;
  const Float3 near_one{a.x / most, a.y / most, a.z / most};
  return near_one * (1 / length(near_one));
}

}  // namespace standoff
