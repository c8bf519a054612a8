// SPDX-License-Identifier: Apache-2.0
// The inner loops of the sign, compiled once per instruction set (kernels_*.cpp) and chosen at run time: which rows of
// samples cross a triangle, in single precision; sums of solid angles of many triangles, in float; and negation.
#pragma once

#include <cstdint>

#include "standoff/execution.h"

namespace standoff::cpu {

/// A triangle, and at most kMostRows rows that may cross it. Coordinates are in samples, relative to a sample near the
/// triangle: x along the row, p and q across it, for y and z.
struct RowPatch {
  static constexpr int kMostRows = 64;
  static constexpr int kMostWidth = 8;  ///< of a patch that is more than one row high
  /// |x|, |p| and |q| of corners and rows are below this: single precision counts so far, and its rounding is less than
  /// a row.
  static constexpr double kMost = 1 << 20;

  /// A place across the rows.
  struct Across {
    float p, q;
  };

  float x[3];                  ///< of the corners
  Across at[3];                ///< of the corners
  float most_x;                ///< bounds the corners' |x|; at least 1
  Across most;                 ///< bounds |p| and |q| of corners and rows; at least `slack`
  float slack;                 ///< the most that coordinates may be off by, beside their rounding to float
  Across first;                ///< the first row
  std::int32_t width, height;  ///< of the patch, in rows
};

/// Rows are numbered 64 * patch + (p - first_p) + width * (q - first_q).
struct CrossedRows {
  static constexpr int kMostPatches = 64;
  static constexpr int kRoom = kMostPatches * RowPatch::kMostRows + 16;  ///< kernels store sixteen at once

  int count, unsure_count;
  bool leaves[kMostPatches];    ///< for each patch: whether rows leave the solid there, along +x
  std::uint32_t row[kRoom];     ///< rows that surely cross the triangle
  float past[kRoom];            ///< for each of these: the first sample that is surely past the crossing
  std::uint32_t unsure[kRoom];  ///< rows that are left to exact arithmetic
};

/// Triangles, coordinate by coordinate: each array may be read kLanes - 1 floats past its end.
struct AngleTriangles {
  static constexpr int kLanes = 16;
  const float* corner[3][3];  ///< corner, axis
};

/// Halves of solid angles as complex numbers with these arguments, multiplied in each lane, and the number of full
/// turns.
struct AngleSums {
  float re[AngleTriangles::kLanes], im[AngleTriangles::kLanes], around[AngleTriangles::kLanes];
};

/// Triangles that are added together.
struct AngleChunk {
  static constexpr int kMost = 64;

  std::uint32_t left[kMost + AngleTriangles::kLanes];  ///< triangles that were left out, because float cannot tell
  int left_count;
  float least_length, least_sq;  ///< the least distance of a corner, and the least |z|^2, of the others
};

/// A solid angle is added if the least distance of a corner is at least kLeastLength of all coordinates together, and
/// |z|^2 of its complex number z = x + iy at least kLeastSq, so that rounding matters little; and not where the angle
/// jumps.
inline constexpr float kLeastLength = 1.0f / 64, kLeastSq = 0.04f;

/// Bounds the error of the argument of a triangle's z. In units of 2^-24, a direction of length l is off by
/// sqrt(3) (M / l + 1), where M bounds the coordinates of triangles and point together. Nine directions move x and y,
/// and 80 roundings of numbers of about 1. The bound is twice the sum. A multiplication adds less than kAngleProduct.
constexpr double angle_error(double coordinates, double least_length, double least_sq_root) {
  constexpr double kAngleProduct = 4;
  return 0x1p-24 * (1.1 * (32 * coordinates / least_length + 200) / least_sq_root + kAngleProduct);
}

struct SignKernels {
  /// Finds the rows that cross the triangles of at most CrossedRows::kMostPatches patches, in any order.
  void (*cross_rows)(const RowPatch* patches, int count, CrossedRows&);
  /// Adds the solid angles of at most AngleChunk::kMost triangles, first to first + count - 1, seen from p (three
  /// floats). Those that have a corner nearer than `least_length`, and some others, are left out (AngleChunk).
  void (*add_solid_angles)(const AngleTriangles&, std::int64_t first, int count, const float* p, float least_length,
                           AngleSums&, AngleChunk&);
  /// Negates the values whose bit is set; a byte has the bits of eight values, the first one in its lowest bit. Zero
  /// stays zero: a sample on the surface has no side.
  void (*negate)(const std::uint8_t* inside, std::int64_t count, float* values);

  static const SignKernels portable, avx2, avx512;  ///< defined in kernels_<set>.cpp
};

/// The kernels for an instruction set; the best one there is for Simd::automatic. Throws Error{usage} where the
/// processor does not have the set.
const SignKernels& sign_kernels_for(Simd simd);

}  // namespace standoff::cpu
