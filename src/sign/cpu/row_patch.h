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

  float x[3], p[3], q[3];        ///< corners
  float most_x, most_p, most_q;  ///< bounds of |x|, |p| and |q|, of corners and rows; at least 1, slack and slack
  float slack;                   ///< what coordinates may be off by, beside their rounding to float
  float first_p, first_q;        ///< the first row
  std::int32_t width, height;    ///< of the patch, in rows
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
