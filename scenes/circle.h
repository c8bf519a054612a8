// SPDX-License-Identifier: Apache-2.0
// Sine and cosine with the same bits everywhere.
#pragma once

#include <cmath>

namespace standoff::scenes {

inline constexpr double kPi = 3.14159265358979323846;

struct CirclePoint {
  double cos, sin;
};

/// The point of the unit circle at `turns` full turns. The sin and cos of a C library may differ in their last bit from
/// machine to machine; sums and products in double precision do not (contraction is off in this project), so the
/// Taylor series are written out here: on the eighth of a turn used, their error is below 1e-16.
inline CirclePoint circle(double turns) {
  turns -= std::floor(turns);
  const int quarter = static_cast<int>(turns * 4) & 3;
  double u = turns - 0.25 * quarter;  // in [0, 1/4)
  const bool mirrored = u > 0.125;
  if (mirrored) u = 0.25 - u;
  const double x = 2 * kPi * u;
  const double q = x * x;
  const double s =
      x * (1 - q / 6 * (1 - q / 20 * (1 - q / 42 * (1 - q / 72 * (1 - q / 110 * (1 - q / 156 * (1 - q / 210)))))));
  const double c =
      1 -
      q / 2 * (1 - q / 12 * (1 - q / 30 * (1 - q / 56 * (1 - q / 90 * (1 - q / 132 * (1 - q / 182 * (1 - q / 240)))))));
  const CirclePoint first = mirrored ? CirclePoint{s, c} : CirclePoint{c, s};
  switch (quarter) {
    case 0:
      return first;
    case 1:
      return {-first.sin, first.cos};
    case 2:
      return {-first.cos, -first.sin};
    default:
      return {first.sin, -first.cos};
  }
}

}  // namespace standoff::scenes
