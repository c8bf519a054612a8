// SPDX-License-Identifier: Apache-2.0
// A field in which every sample can be told from every other, on a grid alike along no two axes.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "standoff/field.h"

namespace standoff {

inline constexpr double kInfinite = std::numeric_limits<double>::infinity();

/// What tests/io/field/foreign.py expects too: exact in float.
inline float odd_value(std::int64_t i, std::int64_t j, std::int64_t k, double thickness) {
  const double value =
      0.25 + 0.5 * static_cast<double>(i) + 16.0 * static_cast<double>(j) + 512.0 * static_cast<double>(k);
  return static_cast<float>(std::min(value, thickness));
}
inline std::uint32_t odd_nearest(std::int64_t i, std::int64_t j, std::int64_t k, double thickness) {
  if (odd_value(i, j, k, kInfinite) >= thickness) return kNoTriangle;
  return static_cast<std::uint32_t>(i + 100 * j + 10000 * k);
}

inline Grid odd_grid() { return {{11, 9, 21}, {-1.5, 0.1, 1e6}, {0.125, 0.3, 2}}; }

inline DistanceField odd_field(const Grid& grid = odd_grid(), double thickness = kInfinite, bool nearest = false) {
  DistanceField field(grid, thickness, nearest);
  field.set_provenance({"tiles", 0x0123456789abcdefu, "1.2.3", ""});
  const Size3 tiles = field.tile_count();
  for (std::int64_t tz = 0; tz < tiles.z; ++tz)
    for (std::int64_t ty = 0; ty < tiles.y; ++ty)
      for (std::int64_t tx = 0; tx < tiles.x; ++tx) {
        if (odd_value(8 * tx, 8 * ty, 8 * tz, kInfinite) >= thickness) continue;
        const auto values = field.store_tile(tx, ty, tz);
        std::uint32_t* const indices = nearest ? field.store_nearest(tx, ty, tz).data() : nullptr;
        for (std::int64_t n = 0; n < 512; ++n) {
          const std::int64_t i = 8 * tx + n % 8, j = 8 * ty + n / 8 % 8, k = 8 * tz + n / 64;
          const bool inside = i < grid.size.x && j < grid.size.y && k < grid.size.z;
          values[n] = inside ? odd_value(i, j, k, thickness) : static_cast<float>(thickness);
          if (indices) indices[n] = inside ? odd_nearest(i, j, k, thickness) : kNoTriangle;
        }
      }
  return field;
}

/// Inside and outside of a ball, clamped at 2: tiles deep inside, tiles far outside and tiles of both, on a grid that
/// no axis of is a multiple of a tile, with the ball reaching past one face.
inline float ball_value(std::int64_t i, std::int64_t j, std::int64_t k) {
  const double x = static_cast<double>(i) - 20, y = static_cast<double>(j) - 21, z = static_cast<double>(k) - 40;
  return static_cast<float>(std::clamp(std::sqrt(x * x + y * y + z * z) - 16, -2.0, 2.0));
}
inline Grid ball_grid() { return {{61, 43, 45}, {-1.5, 0.1, 7}, {1, 1, 1}}; }
inline DistanceField ball_field(bool nearest = false) {
  const Grid grid = ball_grid();
  std::vector<float> values;
  std::vector<std::uint32_t> indices;
  for (std::int64_t k = 0; k < grid.size.z; ++k)
    for (std::int64_t j = 0; j < grid.size.y; ++j)
      for (std::int64_t i = 0; i < grid.size.x; ++i) {
        values.push_back(ball_value(i, j, k));
        if (nearest) indices.push_back(std::abs(values.back()) < 2 ? static_cast<std::uint32_t>(i + j) : kNoTriangle);
      }
  return DistanceField::from_dense(grid, 2, values, indices);
}

}  // namespace standoff
