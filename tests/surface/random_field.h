// SPDX-License-Identifier: Apache-2.0
// Fields that no mesh has.
#pragma once

#include <functional>
#include <limits>
#include <random>
#include <vector>

#include "standoff/field.h"

namespace standoff::testing {

/// A full field of the values that a function has at the samples' positions.
inline DistanceField field_of(const Grid& grid, const std::function<double(Vec3)>& value) {
  std::vector<float> values;
  for (std::int64_t k = 0; k < grid.size.z; ++k)
    for (std::int64_t j = 0; j < grid.size.y; ++j)
      for (std::int64_t i = 0; i < grid.size.x; ++i)
        values.push_back(static_cast<float>(value(grid.position(i, j, k))));
  return DistanceField::from_dense(grid, kFullField, values);
}

enum class Noise {
  smooth,    ///< uniform from -1 to 1
  integers,  ///< -2 to 2: many samples of exactly the iso value 0, many saddles of exactly that value
  extremes,  ///< huge, tiny and infinite values
};

/// A field of noise: each cell has any of its 256 cases.
inline DistanceField noise_field(const Grid& grid, Noise noise, unsigned seed, double thickness = kFullField) {
  std::mt19937 random(seed);
  const float huge = std::numeric_limits<float>::max(), tiny = std::numeric_limits<float>::denorm_min(),
              infinite = std::numeric_limits<float>::infinity();
  const std::vector<float> extremes{-infinite, -huge, -1, -tiny, -0.0f, 0, tiny, 1e-30f, 1, huge, infinite};
  std::vector<float> values(static_cast<std::size_t>(grid.sample_count()));
  for (float& value : values) {
    if (noise == Noise::smooth) value = static_cast<float>(static_cast<double>(random()) * 0x1p-31 - 1);
    if (noise == Noise::integers) value = static_cast<float>(static_cast<int>(random() % 5) - 2);
    if (noise == Noise::extremes) value = extremes[random() % extremes.size()];
  }
  return DistanceField::from_dense(grid, thickness, values);
}

}  // namespace standoff::testing
