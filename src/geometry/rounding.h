// SPDX-License-Identifier: Apache-2.0
// Bounds of rounding errors, for error analyses of sums and products.
//
// Each rounded operation multiplies its exact result by 1 + d, |d| <= u, the unit roundoff. After n of them the product
// of the factors lies within 1 +- gamma(n), gamma(n) = n u / (1 - n u).
// Source: N. J. Higham, Accuracy and Stability of Numerical Algorithms, 2nd edition (2002), lemma 3.1.
#pragma once

namespace standoff {

/// The unit roundoff: the largest relative error of one operation that rounds to nearest.
inline constexpr double kRoundoffFloat = 0x1p-24, kRoundoffDouble = 0x1p-53;

/// Is added to the error bound of a determinant of three differences: products below it may have lost digits to
/// underflow. World units, cubed.
inline constexpr double kUnderflowOf3d = 1e-290;
/// The same for two differences. World units, squared.
inline constexpr double kUnderflowOf2d = 1e-290;

/// The relative error of n operations in float, n far below 2^24.
constexpr double gamma_float(int n) { return n * kRoundoffFloat / (1 - n * kRoundoffFloat); }
/// The same in double.
constexpr double gamma_double(int n) { return n * kRoundoffDouble / (1 - n * kRoundoffDouble); }

/// The error that compute() promises for a sample at `distance` from the mesh (docs/tiles.md), beside the resolution of
/// doubles if the grid is far from the origin. `spacing`: the grid's largest. All are in one unit. verify() allows this
/// error, and bounds stored in bodies are lowered by it.
constexpr double promised_error(double distance, double spacing) { return 1e-6 * (distance + 16 * spacing); }

}  // namespace standoff
