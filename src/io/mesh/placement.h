// SPDX-License-Identifier: Apache-2.0
// Where a node of a scene stands.
#pragma once

#include <array>
#include <cstddef>

#include "standoff/vec.h"

namespace standoff {

/// An affine map: rows of a matrix, the shift in their last column.
struct Placement {
  std::array<std::array<double, 4>, 3> rows{{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};

  Vec3 operator()(Vec3 p) const {
    const auto along = [&](const std::array<double, 4>& r) { return r[0] * p.x + r[1] * p.y + r[2] * p.z + r[3]; };
    return {along(rows[0]), along(rows[1]), along(rows[2])};
  }

  /// First `inner`, then this one.
  Placement operator*(const Placement& inner) const {
    Placement both{};
    for (std::size_t r = 0; r < 3; ++r)
      for (std::size_t c = 0; c < 4; ++c) {
        double sum = c == 3 ? rows[r][3] : 0;
        for (std::size_t k = 0; k < 3; ++k) sum += rows[r][k] * inner.rows[k][c];
        both.rows[r][c] = sum;
      }
    return both;
  }

  /// Whether it turns left hands into right hands.
  bool mirrors() const {
    const auto& [a, b, c] = rows;
    return a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) +
               a[2] * (b[0] * c[1] - b[1] * c[0]) <
           0;
  }
};

}  // namespace standoff
