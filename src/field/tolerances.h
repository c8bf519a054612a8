// SPDX-License-Identifier: Apache-2.0
// The constants of the method `tiles` that the CPU and the GPU, or several kernels, share: what decides the bits of a
// field, what rounding may add to a box or a distance, and which algorithm a thickness gets. Lengths are in grid units
// (lattice.h): the largest spacing is 1 to 2 of them, the grid far from the origin or not.
#pragma once

#include "geometry/rounding.h"
#include "geometry/triangle_box.h"
#include "standoff/grid.h"

namespace standoff {

/// Triangles whose box has a longer side are set up in double, shorter ones in float. Grid units. At 16 a triangle's
/// corners lie within 40 units of the brick's centre, where float resolves 4e-6, against a promise of 1.6e-5: the tests
/// of exactness measure a quarter of the promise at most. Decides bits. Smaller: more triangles take the slower set-up
/// in double. Larger: errors grow with it, beyond the promise from some 64 on.
inline constexpr float kLongTriangle = 16;

/// Edges and altitudes whose square is smaller count as zero when a triangle is set up for samples. Squared grid units:
/// a tenth of the promised error. Decides bits. Larger: needles are measured as lines that are not. Smaller: slivers
/// get frames whose directions are rounding.
inline constexpr float kLeastLengthSq = 1e-12f;
/// The same where a triangle is set up in double to be compared with cells' centres alone, which decides no bit.
inline constexpr double kLeastLengthSqOfCells = 1e-24;

/// What rounding may add to a distance when blocks, tiles and cells are culled. Grid units: a distance of 300 that took
/// ten operations in float is off by 2e-4. Decides no bit while it is above rounding; below it samples lose their
/// nearest triangle. Larger: more candidates are kept.
inline constexpr float kSlack = 1e-3f;
static_assert(kSlack > 300 * gamma_float(10));

/// The same as a share, of lengths of any size: thicknesses, radii, distances found so far. Ten operations are off by
/// 6e-7. Smaller or larger: as kSlack.
inline constexpr float kSlackRatio = 1e-3f;
static_assert(kSlackRatio > gamma_float(10));

/// What a distance in a triangle's frame may be off by on the CPU, as a share of the distance between the brick's
/// centre and the triangle's farthest corner or, if that is farther, the sample: 32 units of rounding
/// (geometry/triangle_frame.h). Decides no bit while it is above that; with less, culling may drop the triangle that is
/// nearest. Larger: more candidates are kept, of a mesh smaller than a sample nearly all.
inline constexpr float kFrameError = 32 * 0x1p-23f;

/// The same of a long triangle, whose frame only culls it: it is measured by its lines, those of corners in double.
/// Larger, because corners lose more to rounding, the longer the triangle.
inline constexpr float kLongFrameError = 1.75f * kFrameError;

/// The rest of that error, in grid units, so that the farthest corner alone counts: samples are up to 26 from the
/// brick's centre, edges and altitudes below 1e-6 count as zero, and the corners of cells are rounded (1e-5).
inline constexpr float kFrameSlack = 1.2e-4f;
static_assert(kFrameSlack > 26 * kFrameError + 2e-6f + 1e-5f && kLeastLengthSq <= 1e-12f);

/// The share of a distance by which the error of a long triangle's lines may grow, beside kSlack. Decides no bit while
/// it is above 2 kFrameError. Larger: more candidates are kept where some are long.
inline constexpr float kSlackShare = 1e-4f;
static_assert(kSlackShare > 2 * kFrameError);

/// The same of distances between samples and points or boxes, whose squares take six operations.
inline constexpr float kSquareRounding = 1e-6f;
static_assert(kSquareRounding > gamma_float(6));

/// The GPU culls in coordinates relative to coarse cells, which may be large: this share of the farthest coordinate
/// comes on top of kSlack. 64 roundings.
inline constexpr float kSlackOfCoordinate = 4e-6f;
static_assert(kSlackOfCoordinate > gamma_float(64));

/// What the bound b of the test `bisector` (docs/cuda.md) is raised by, as a share, beside the slack that is in b and d
/// already. Decides no bit while it is above the rounding of the test's operations; below it samples lose their nearest
/// triangle. Larger: more candidates are kept.
inline constexpr float kBisectorSlack = 1e-5f;
static_assert(kBisectorSlack > gamma_float(16));

/// What rounding may add to a box in samples, or to a distance between cells as a share, both in double. Far above
/// double's rounding, far below one sample: larger, and triangles are put into bricks that they do not reach; smaller,
/// and grids 2^30 spacings from the mesh lose triangles.
inline constexpr double kBoxSlack = 1e-6;
static_assert(kBoxSlack > 0x1p30 * gamma_double(4));

/// Up to this thickness, in spacings, the GPU sorts triangles straight into tiles: nearly all that are sorted then lie
/// within the thickness of some sample. Beyond, candidates are handed down from coarse cells, since most triangles are
/// farther than others everywhere. Decides speed alone: both algorithms give the same field. The CPU counts
/// (cpu/band_choice.h).
inline constexpr double kThinBand = 4;
STANDOFF_HD inline bool is_thin(double max_spacing, double thickness) { return thickness <= kThinBand * max_spacing; }
inline bool is_thin(const Grid& grid, double thickness) { return is_thin(grid.max_spacing(), thickness); }

/// In full fields, and in bands of more than kLeastSpeckBand spacings, a triangle whose box is smaller than this share
/// of its distance from a brick and kSpeckSpacings together counts there as the box's middle: a *speck*. So where a
/// mesh is far smaller than a sample, its triangles become points that can be culled, and equal points are measured
/// once. Decides bits: a point of a box is within 0.87 of its side of the middle, which makes, with the rounding of a
/// point's distance, less than what is promised, 1e-6 of the distance and 16 spacings together. Smaller: a mesh must be
/// smaller until its triangles become points.
inline constexpr float kSpeck = 6e-7f;
inline constexpr float kSpeckSpacings = 16;  // grid units, so at most that many spacings
inline constexpr double kLeastSpeckBand = 16;
/// What rounding may change of the squared distance from a point, as a share: six operations, half of which are a share
/// of the distance. Rounding the box's corners and its middle adds a quarter of a millionth of the point's coordinates.
inline constexpr float kSpeckRounding = 6 * 0x1p-24f;
static_assert(0.87f * kSpeck + kSpeckRounding / 2 + 0.25e-6f < 1e-6f && kSpeck + kSpeckRounding < kFrameError);

// Which triangles are set up for samples in float, and which in double. This decides bits, so the CPU, sixteen
// triangles at a time, and the GPU, one, ask here.

/// Whether a triangle whose corners have this box, in coordinates of a brick in F, is set up in double and measured by
/// lines: bool for float, a mask for wide floats.
template <class F>
STANDOFF_INLINE auto is_long(const BoxOf<F>& box) {
  return less(F(kLongTriangle), longest_side(box));
}

}  // namespace standoff
