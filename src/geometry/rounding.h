// SPDX-License-Identifier: Apache-2.0
// How far rounding moves a computed number: the bound that error analyses of sums and products are written with.
//
// Each rounded operation multiplies its exact result by 1 + d, |d| <= u, the unit roundoff. After n of them the product
// of the factors lies within 1 +- gamma(n), gamma(n) = n u / (1 - n u).
// Source: N. J. Higham, Accuracy and Stability of Numerical Algorithms, 2nd edition (2002), lemma 3.1.
#pragma once

namespace standoff {

/// The unit roundoff: the largest relative error of one operation that rounds to nearest.
inline constexpr double kRoundoffFloat = 0x1p-24, kRoundoffDouble = 0x1p-53;

/// Added to the bound of a determinant of three differences: products below it may have lost digits to underflow. In
/// world units, cubed.
inline constexpr double kUnderflowOf3d = 1e-290;
/// The same of two differences, squared.
inline constexpr double kUnderflowOf2d = 1e-290;

/// The relative error of n operations in float, n far below 2^24.
constexpr double gamma_float(int n) { return n * kRoundoffFloat / (1 - n * kRoundoffFloat); }
/// The same in double.
constexpr double gamma_double(int n) { return n * kRoundoffDouble / (1 - n * kRoundoffDouble); }

// The error that compute() promises of a field (docs/tiles.md): what verify() allows, and what bounds stored in bodies
// are lowered by.

/// The most that a sample at `distance` from the mesh is off by, beside the resolution of doubles where the grid is far
/// from the origin; `spacing` is the grid's largest. All in one unit.
constexpr double promised_error(double distance, double spacing) { return 1e-6 * (distance + 16 * spacing); }

}  // namespace standoff
