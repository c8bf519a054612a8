// SPDX-License-Identifier: Apache-2.0
// A regular lattice of samples in the unit space, and what lies between them.
#pragma once

#include <cstddef>
#include <optional>

#include "render/float3.h"

namespace standoff {

struct UnitLattice {
  Float3 origin;
  float spacing = 1;
  std::size_t size[3] = {0, 0, 0};  ///< x, the fastest, y and z

  /// The cell of eight samples around a place.
  struct Cell {
    std::size_t first;  ///< the number of its sample of least x, y and z
    float x, y, z;      ///< where the place lies in it, 0 to 1
  };

  std::size_t samples() const { return size[0] * size[1] * size[2]; }

  Float3 place(std::size_t sample) const {
    return origin + Float3{static_cast<float>(sample % size[0]), static_cast<float>(sample / size[0] % size[1]),
                           static_cast<float>(sample / (size[0] * size[1]))} *
                        spacing;
  }

  /// Nothing outside the samples.
  std::optional<Cell> cell(Float3 place) const {
    const Float3 at = (place - origin) * (1 / spacing);
    // Also false for what is not a number.
    if (!(at.x >= 0 && at.x + 1 < static_cast<float>(size[0]) && at.y >= 0 && at.y + 1 < static_cast<float>(size[1]) &&
          at.z >= 0 && at.z + 1 < static_cast<float>(size[2])))
      return {};
    const int x = static_cast<int>(at.x), y = static_cast<int>(at.y), z = static_cast<int>(at.z);
    return Cell{
        static_cast<std::size_t>(x) + size[0] * (static_cast<std::size_t>(y) + size[1] * static_cast<std::size_t>(z)),
        at.x - static_cast<float>(x), at.y - static_cast<float>(y), at.z - static_cast<float>(z)};
  }

  /// Between the values of a cell's samples; `value` gives that of a sample.
  template <class Value>
  float interpolate(const Cell& cell, const Value& value) const {
    const auto along_x = [&](std::size_t sample) {
      const float low = value(sample);
      return low + (value(sample + 1) - low) * cell.x;
    };
    const auto along_y = [&](std::size_t sample) {
      const float low = along_x(sample);
      return low + (along_x(sample + size[0]) - low) * cell.y;
    };
    const float low = along_y(cell.first);
    return low + (along_y(cell.first + size[0] * size[1]) - low) * cell.z;
  }
};

}  // namespace standoff
