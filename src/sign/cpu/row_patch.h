// SPDX-License-Identifier: Apache-2.0
// Which rows of samples cross a triangle, asked in single precision: what kernels take and what they find.
#pragma once

#include <cstdint>

namespace standoff::cpu {

/// A triangle, and at most kMostRows rows that may cross it. Coordinates are in samples, relative to a sample near the
/// triangle: x along the row, p and q across it, for y and z.
struct RowPatch {
  static constexpr int kMostRows = 64;
  static constexpr int kMostWidth = 8;  ///< of a patch that is more than one row high
  /// What |x|, |p| and |q| are below, of corners and rows: single precision counts so far, and its rounding is less
  /// than a row.
  static constexpr double kMost = 1 << 20;

  /// A place across the rows.
  struct Across {
    float p, q;
  };

  float x[3];                  ///< of the corners
  Across at[3];                ///< of the corners
  float most_x;                ///< a bound of the corners' |x|, at least 1
  Across most;                 ///< bounds of |p| and |q|, of corners and rows, at least `slack`
  float slack;                 ///< what coordinates may be off by, beside their rounding to float
  Across first;                ///< the first row
  std::int32_t width, height;  ///< of the patch, in rows
};

/// Rows are numbered 64 * patch + (p - first_p) + width * (q - first_q).
struct CrossedRows {
  static constexpr int kMostPatches = 64;
  static constexpr int kRoom = kMostPatches * RowPatch::kMostRows + 16;  ///< kernels store sixteen at once

  int count, unsure_count;
  bool leaves[kMostPatches];    ///< of each patch, whether rows leave the solid there, along +x
  std::uint32_t row[kRoom];     ///< rows that surely cross the triangle
  float past[kRoom];            ///< of these, the first sample past the crossing, surely
  std::uint32_t unsure[kRoom];  ///< rows that are left to exact arithmetic
};

}  // namespace standoff::cpu
