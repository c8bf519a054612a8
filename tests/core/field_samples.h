// SPDX-License-Identifier: Apache-2.0
// A grid and values for the tests of fields.
#pragma once

#include <cstddef>
#include <random>
#include <vector>

#include "standoff/grid.h"

namespace standoff {

// No axis a multiple of a tile, none alike.
inline const Grid kGrid{{19, 10, 26}, {-1, 2, 30}, {0.5, 0.25, 2}};

inline std::vector<float> numbers(const Grid& grid, float most) {
  std::mt19937 random(5);
  std::vector<float> values(static_cast<std::size_t>(grid.sample_count()));
  for (float& value : values) value = most * static_cast<float>(random() % 1000) / 1000;
  return values;
}

}  // namespace standoff
