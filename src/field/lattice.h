// SPDX-License-Identifier: Apache-2.0
// The grid as the backends see it: tiles of 8x8x8 samples in bricks of 2x2x2 tiles. The brick's centre is the origin of
// all float coordinates in it. CPU and GPU get the same bits because both compute these coordinates here.
//
//   world units --(* scale)--> grid units --(- brick's centre, in double)--> local coordinates, float
//
// The origin belongs to the brick, not to the tile, because a triangle is set up once for each origin: small triangles
// touch half as many bricks as tiles.
#pragma once

#include <cmath>
#include <cstdint>

#include "core/grid_axis.h"
#include "core/tile_count.h"
#include "field/tolerances.h"
#include "geometry/host_device.h"
#include "geometry/triangle_box.h"
#include "geometry/triangle_frame.h"
#include "geometry/triple.h"
#include "standoff/field.h"
#include "standoff/grid.h"

namespace standoff {

inline constexpr int kBrickSide = 2 * kTileSide;

/// Lengths are in grid units: world units times `scale`, a power of two that brings the largest spacing to [1, 2). So
/// scaling is exact, and no mesh is too small or too large for float.
struct Lattice {
  double scale;
  double origin[3];   ///< of the whole grid, world units
  double first[3];    ///< of the window, in samples of the whole grid; a multiple of kBrickSide
  double spacing[3];  ///< world units
  double unit[3];     ///< spacing, grid units
  std::int64_t size[3];
  std::int64_t tiles[3];
  double to_samples[3];             ///< 1 / spacing, world units
  double reach[3];                  ///< the thickness in samples, with a margin for rounding
  double thickness_units;           ///< grid units; this and the next three may be infinite
  float coordinate[3][kBrickSide];  ///< the samples of a brick relative to its centre, grid units
  float thickness, thickness_sq;    ///< grid units
  float thickness_world;
  float unscale;  ///< 1 / scale
  float speck;    ///< kSpeck, or 0 if no triangle counts as a speck

  STANDOFF_HD std::int64_t tile_count() const { return tiles[0] * tiles[1] * tiles[2]; }
  STANDOFF_HD std::int64_t tile(std::int64_t x, std::int64_t y, std::int64_t z) const {
    return x + tiles[0] * (y + tiles[1] * z);
  }
};

/// The coordinate of sample n of a brick, relative to its centre. Grid units.
STANDOFF_HD inline float brick_coordinate(const Lattice& l, int n, int axis) {
  return static_cast<float>((n - (kBrickSide - 1) / 2.0) * l.unit[axis]);
}

/// Requires the axes of a valid grid that begins at a brick of the whole grid, and a positive thickness. Host and
/// device get the same bits: all operations are exact or correctly rounded.
STANDOFF_HD inline Lattice lattice_of(const GridAxis (&axes)[3], double thickness) {
  Lattice l{};
  const double largest = max(max(axes[0].spacing, axes[1].spacing), axes[2].spacing);
  l.scale = std::ldexp(1.0, -std::ilogb(largest));
  for (int axis = 0; axis < 3; ++axis) {
    const GridAxis& along = axes[axis];
    l.origin[axis] = along.origin;
    l.first[axis] = static_cast<double>(along.first);
    l.spacing[axis] = along.spacing;
    l.unit[axis] = along.spacing * l.scale;
    l.size[axis] = along.size;
    l.tiles[axis] = tiles_along(along.size);
    l.to_samples[axis] = 1 / along.spacing;
    l.reach[axis] = thickness * l.to_samples[axis] + double{kSlack} / l.unit[axis] + 2 * kBoxSlack;
    for (int n = 0; n < kBrickSide; ++n) l.coordinate[axis][n] = brick_coordinate(l, n, axis);
  }
  l.thickness_units = thickness * l.scale;
  l.thickness = static_cast<float>(thickness * l.scale);
  l.thickness_sq = l.thickness * l.thickness;
  l.thickness_world = static_cast<float>(thickness);
  l.unscale = static_cast<float>(1 / l.scale);
  l.speck = thickness > kLeastSpeckBand * largest ? kSpeck : 0;
  return l;
}
inline Lattice make_lattice(const Grid& grid, double thickness) {
  return lattice_of({axis_of(grid, 0), axis_of(grid, 1), axis_of(grid, 2)}, thickness);
}

/// Whether bricks of the whole grid begin where the grid begins: they may be cut at its end alone.
inline bool begins_at_brick(const Grid& grid) {
  return grid.first.x % kBrickSide == 0 && grid.first.y % kBrickSide == 0 && grid.first.z % kBrickSide == 0;
}

/// Bricks of a grid.
inline std::int64_t brick_count(const Grid& grid) {
  const auto along = [](std::int64_t samples) { return (samples + kBrickSide - 1) / kBrickSide; };
  return along(grid.size.x) * along(grid.size.y) * along(grid.size.z);
}

/// The position of sample (x, y, z); fractions are allowed. Grid units.
STANDOFF_INLINE Triple<double> position(const Lattice& l, double x, double y, double z) {
  return {(l.origin[0] + l.spacing[0] * (l.first[0] + x)) * l.scale,
          (l.origin[1] + l.spacing[1] * (l.first[1] + y)) * l.scale,
          (l.origin[2] + l.spacing[2] * (l.first[2] + z)) * l.scale};
}

/// The middle of the samples of cell (x, y, z), where cells have kSide samples per axis. Grid units.
template <int kSide>
STANDOFF_INLINE Triple<double> cell_center(const Lattice& l, std::int64_t x, std::int64_t y, std::int64_t z) {
  constexpr double middle = (kSide - 1) / 2.0;
  return position(l, static_cast<double>(x * kSide) + middle, static_cast<double>(y * kSide) + middle,
                  static_cast<double>(z * kSide) + middle);
}

/// The centre of the brick that holds tile (tx, ty, tz).
STANDOFF_INLINE Triple<double> brick_center(const Lattice& l, const std::int64_t* tile) {
  return cell_center<kBrickSide>(l, tile[0] >> 1, tile[1] >> 1, tile[2] >> 1);
}

/// A point in world units relative to `center`, which is in grid units. The product is exact, so fusing changes no bit.
STANDOFF_INLINE Triple<double> local(const Lattice& l, const Triple<double>& point, const Triple<double>& center) {
  return {fma(point.x, l.scale, -center.x), fma(point.y, l.scale, -center.y), fma(point.z, l.scale, -center.z)};
}

STANDOFF_INLINE Triple<float> narrowed(const Triple<double>& p) {
  return {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
}

STANDOFF_INLINE void tile_at(const Lattice& l, std::int64_t index, std::int64_t* tile) {
  tile[0] = index % l.tiles[0];
  tile[1] = index / l.tiles[0] % l.tiles[1];
  tile[2] = index / (l.tiles[0] * l.tiles[1]);
}

/// The number of samples inside the grid along one axis of a tile or brick, which has kSide samples per axis.
template <int kSide>
STANDOFF_INLINE int inside(const Lattice& l, const std::int64_t* at, int axis) {
  const std::int64_t left = l.size[axis] - at[axis] * kSide;
  return left < kSide ? static_cast<int>(left) : kSide;
}

/// Whether a triangle with this box, relative to a brick's centre, is a speck from all samples of the brick: bool for
/// float, a mask for wide floats.
template <class F>
STANDOFF_INLINE auto is_speck(const Lattice& l, const BoxOf<F>& box) {
  constexpr int kLast = kBrickSide - 1;
  const F x = max(box.low.x, F(-box.high.x)) - F(l.coordinate[0][kLast]),
          y = max(box.low.y, F(-box.high.y)) - F(l.coordinate[1][kLast]),
          z = max(box.low.z, F(-box.high.z)) - F(l.coordinate[2][kLast]);
  const F away = max(x, max(y, max(z, F(0)))) + F(kSpeckSpacings);
  return less(longest_side(box), away * F(l.speck));
}

// The cells that a triangle is a candidate of: bricks on the CPU, tiles on the GPU. They are the cells that its box,
// grown by the thickness, touches. A long triangle misses most of these, so their centres are tested too.

/// Cells low[axis] to high[axis], both included; empty if low > high on some axis.
struct CellRange {
  std::int64_t low[3], high[3];

  STANDOFF_HD bool empty() const { return low[0] > high[0] || low[1] > high[1] || low[2] > high[2]; }
  /// At most two cells per axis: a triangle becomes a candidate of all of them without a test.
  STANDOFF_HD bool is_small() const { return high[0] - low[0] <= 1 && high[1] - low[1] <= 1 && high[2] - low[2] <= 1; }
};

/// The cells of kSide samples per axis that hold samples of the box (world units) grown by the lattice's thickness.
template <int kSide>
STANDOFF_INLINE CellRange reached_cells(const Lattice& l, const BoxOf<double>& box) {
  const double lows[3] = {box.low.x, box.low.y, box.low.z}, highs[3] = {box.high.x, box.high.y, box.high.z};
  CellRange range;
  for (int axis = 0; axis < 3; ++axis) {
    const double past = static_cast<double>(l.size[axis]);
    const double from = (lows[axis] - l.origin[axis]) * l.to_samples[axis] - l.first[axis] - l.reach[axis];
    const double to = (highs[axis] - l.origin[axis]) * l.to_samples[axis] - l.first[axis] + l.reach[axis];
    // Find the first sample at or above `from` and the last at or below `to`, by truncating numbers that are not
    // negative.
    const auto first = static_cast<std::int64_t>(min(max(from + (1 - kBoxSlack), 0.0), past));
    const auto last = static_cast<std::int64_t>(min(max(to + 1, 0.0), past)) - 1;
    range.low[axis] = first / kSide;
    range.high[axis] = last < first ? -1 : last / kSide;
  }
  return range;
}

/// An upper bound of the squared distance between a cell's centre and a triangle within the thickness of a sample of
/// the cell. Grid units.
template <int kSide>
STANDOFF_INLINE double cell_reach_sq(const Lattice& l) {
  double radius_sq = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double half = l.unit[axis] * (kSide - 1) / 2;
    radius_sq += half * half;
  }
  const double reach = (l.thickness_units + sqrt(radius_sq) + double{kSlack}) * (1 + kBoxSlack);
  return reach * reach;
}

/// A long triangle relative to the centre of the first cell of its range.
template <int kSide>
struct LongTriangle {
  TriangleFrame<double> frame;
  CellRange range;

  /// Corners in world units.
  STANDOFF_INLINE LongTriangle(const Lattice& l, const CellRange& cells, const Triple<double> (&corner)[3])
      : range(cells) {
    const Triple<double> first = cell_center<kSide>(l, cells.low[0], cells.low[1], cells.low[2]);
    frame = make_frame(local(l, corner[0], first), local(l, corner[1], first), local(l, corner[2], first),
                       double{kLeastLengthSqOfCells});
  }

  /// The centre of a cell, relative to the first one's.
  STANDOFF_INLINE Triple<double> center(const Lattice& l, std::int64_t x, std::int64_t y, std::int64_t z) const {
    return {l.unit[0] * kSide * static_cast<double>(x - range.low[0]),
            l.unit[1] * kSide * static_cast<double>(y - range.low[1]),
            l.unit[2] * kSide * static_cast<double>(z - range.low[2])};
  }
  /// Whether the triangle is within cell_reach_sq() of the centre of a cell.
  STANDOFF_INLINE bool reaches(const Lattice& l, std::int64_t x, std::int64_t y, std::int64_t z,
                               double reach_sq) const {
    return distance_sq(frame, center(l, x, y, z)) <= reach_sq;
  }
};

}  // namespace standoff
