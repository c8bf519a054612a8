// SPDX-License-Identifier: Apache-2.0
// The inner loops of the sign, compiled once per instruction set (kernels_*.cpp) and chosen at run time: which rows of
// samples cross a triangle, in single precision; sums of solid angles of many triangles, in float;
// sums of winding numbers along rows; and negation.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include "standoff/execution.h"
#include "standoff/sign.h"

namespace standoff::cpu {

/// The rows of a grid along x, and a window of them. Axis 0 is x; y and z count rows.
struct RowSpace {
  double origin[3], spacing[3], per_spacing[3];
  double first[3];          ///< the number that the grid's first sample has
  double size_x;            ///< samples of a row
  double begin[3], end[3];  ///< the window, along y and z
  double tile[3];           ///< the first row of the window's first tile, along y and z
  float tiles_y;            ///< tiles of the grid along y
  double slack;             ///< the most that coordinates in samples may be off by, beside their rounding to float
};

/// The search for rows takes a corner to be off by this much, in samples: far more than by rounding.
inline constexpr double kNearRow = 0x1p-16;

/// Corners of triangles, coordinate by coordinate.
struct RowCorners {
  static constexpr int kMost = 64;
  double at[3][3][kMost];  ///< axis, corner, triangle
};

/// The rows that triangles may cross, and what decides it. Coordinates are in samples, relative to a sample near the
/// triangle: `base` along x, and the first of its rows.
struct RowTriangles {
  static constexpr int kMost = RowCorners::kMost;
  /// |x|, |p| and |q| of corners and rows are below this: single precision counts so far, and its rounding is less than
  /// a row.
  static constexpr double kMostCoordinate = 1 << 20;
  /// Rows have fewer samples, so that float has the number of each.
  static constexpr std::int64_t kMostSamples = 1 << 24;

  std::uint64_t any;            ///< a bit for each triangle that may cross rows; the others have no values
  std::uint64_t fits;           ///< a bit for each of these whose coordinates are below kMostCoordinate
  std::int32_t rows[3][kMost];  ///< along y and z
  float first[3][kMost];        ///< the first row along y and z, from the window's first tile
  float at[3][3][kMost];        ///< axis, corner, triangle: x, p along y, q along z
  float most[3][kMost];         ///< bounds the coordinates of corners and rows; at least 1 along x, and `slack`
  float base[kMost];
  float side[3][3][kMost];                      ///< of each side: E = side[0] + side[1] p + side[2] q
  float plane[3][kMost];                        ///< x = plane[0] + plane[1] p + plane[2] q
  float side_bound[kMost], plane_bound[kMost];  ///< bound their errors
  float enters[kMost];                          ///< 1 where rows enter the solid there, along +x; else 0
};

/// Some rows of a triangle: a rectangle of them.
struct RowStrip {
  static constexpr int kMostRows = 64;
  static constexpr int kMostWidth = 8;  ///< of a strip that is more than one row high

  std::int32_t triangle;
  std::int32_t p, q;           ///< the first row
  std::int32_t width, height;  ///< in rows
};

struct CrossedRows {
  static constexpr int kMostStrips = 64;
  static constexpr int kRoom = kMostStrips * RowStrip::kMostRows + 16;  ///< kernels store sixteen at once

  int count, unsure_count;
  /// For each row that surely crosses a triangle: 2 * row + (whether it enters the solid), with the row as in
  /// FoundCrossing, and the first sample that is past the crossing.
  float row[kRoom], past[kRoom];
  std::uint32_t unsure[kRoom];  ///< rows that are left to exact arithmetic: kMostRows * strip + p + width * q
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

  /// No triangle.
  static AngleSums none() {
    AngleSums sums{};
    for (float& re : sums.re) re = 1;
    return sums;
  }
  /// The sum in full turns.
  double turns() const {
    double sum = 0;
    for (int n = 0; n < AngleTriangles::kLanes; ++n)
      sum += double{around[n]} + std::atan2(double{im[n]}, double{re[n]}) / (2 * std::numbers::pi);
    return sum;
  }
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

/// From the first tile of a row of tiles to before the end.
struct TileRange {
  std::int64_t first, end;
};

struct SignKernels {
  /// Finds the rows that the first `count` triangles may cross: at most one too many at each end, along y and z.
  void (*find_rows)(const RowCorners&, int count, const RowSpace&, RowTriangles&);
  /// Finds which rows of at most CrossedRows::kMostStrips strips cross their triangles, in any order.
  void (*cross_rows)(const RowTriangles&, const RowStrip* strips, int count, const RowSpace&, CrossedRows&);
  /// Adds the solid angles of at most AngleChunk::kMost triangles, first to first + count - 1, seen from p (three
  /// floats). Those that have a corner nearer than `least_length`, and some others, are left out (AngleChunk).
  void (*add_solid_angles)(const AngleTriangles&, std::int64_t first, int count, const float* p, float least_length,
                           AngleSums&, AngleChunk&);
  /// Marks the samples inside of 64 rows of tiles side by side, as in InsideRows, whose bits are 0. `steps` has the
  /// changes of the winding number, by sample, then by row, which are 0 in tiles that are not stepped; resets both.
  /// Returns the range of the tiles that have samples inside.
  TileRange (*mark_inside)(std::int8_t* steps, std::uint8_t* is_stepped, std::int64_t tiles, WindingRule rule,
                           std::uint8_t* inside);
  /// Negates the values whose bit is set; a byte has the bits of eight values, the first one in its lowest bit. Zero
  /// stays zero: a sample on the surface has no side.
  void (*negate)(const std::uint8_t* inside, std::int64_t count, float* values);

  static const SignKernels portable, avx2, avx512;  ///< defined in kernels_<set>.cpp
};

}  // namespace standoff::cpu
