// SPDX-License-Identifier: Apache-2.0
// Sums of solid angles of many triangles, in float, with a bound of what they are off by.
#pragma once

#include <cstdint>

namespace standoff::cpu {

/// Triangles, coordinate by coordinate: each array may be read kLanes - 1 floats past its end.
struct AngleTriangles {
  static constexpr int kLanes = 16;
  const float* corner[3][3];  ///< corner, axis
};

/// Halves of solid angles as complex numbers with these arguments, multiplied in each lane, and how often that went
/// around.
struct AngleSums {
  float re[AngleTriangles::kLanes], im[AngleTriangles::kLanes], around[AngleTriangles::kLanes];
};

/// Triangles that are added together.
struct AngleChunk {
  static constexpr int kMost = 64;

  std::uint32_t left[kMost + AngleTriangles::kLanes];  ///< those that were left out: where float will not do
  int left_count;
  float least_length, least_sq;  ///< of the others: the least distance of a corner, the least |z|^2
};

/// Solid angles are added where the least distance of a corner is at least this part of all coordinates together, so
/// that rounding matters little, and where |z|^2 of z = x + iy, the complex number, is not less; and not where the
/// angle jumps.
inline constexpr float kLeastLength = 1.0f / 64, kLeastSq = 0.04f;

/// What the argument of a triangle's z may be off by, in 2^-24: a direction is off by sqrt(3) (M / l + 1), M the
/// coordinates of triangles and point together, l its length. Nine of these move x and y, and 80 roundings of numbers
/// of about 1. The bound is twice that. Multiplying adds less than kAngleProduct.
constexpr double angle_error(double coordinates, double least_length, double least_sq_root) {
  constexpr double kAngleProduct = 4;
  return 0x1p-24 * (1.1 * (32 * coordinates / least_length + 200) / least_sq_root + kAngleProduct);
}

}  // namespace standoff::cpu
