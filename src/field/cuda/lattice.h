// The grid as the GPU kernels see it: tiles of 8x8x8 samples, which are the unit of work, in bricks of 2x2x2 tiles,
// whose centres are the origins of all float coordinates, as on the CPU: that is what makes the bits the same.
#pragma once

#include <cmath>
#include <cstdint>

#include "geometry/host_device.h"
#include "geometry/triple.h"
#include "standoff/grid.h"

namespace standoff::gpu {

inline constexpr int kTileSide = 8;
inline constexpr int kTileSamples = kTileSide * kTileSide * kTileSide;
inline constexpr int kBrickSide = 16;

/// Triangles with a longer side of their box, in grid units, are set up in double (kernels_body.h of the CPU explains
/// the value, and the next one).
inline constexpr float kLongTriangle = 16;
inline constexpr float kLeastLengthSq = 1e-12f;
/// What rounding may add to a distance in culling: `slack` grid units, and this share of the farthest coordinate.
inline constexpr float kSlack = 1e-3f;
inline constexpr float kSlackShare = 4e-6f;
/// The same for boxes in double, in samples.
inline constexpr double kBoxSlack = 1e-6;

/// Lengths are in grid units: world units times `scale`, a power of two that brings the largest spacing to [1, 2).
struct Lattice {
  double scale;
  double origin[3];   // world units
  double spacing[3];  // world units
  double unit[3];     // spacing, grid units
  std::int64_t size[3];
  std::int64_t tiles[3];
  double to_samples[3];  // 1 / spacing
  double reach[3];       // the thickness, in samples, with a margin
  double thickness_units;
  float coordinate[3][kBrickSide];  // of a brick's samples relative to its centre, grid units
  float thickness, thickness_sq;    // grid units
  float thickness_world;
  float unscale;

  STANDOFF_HD std::int64_t tile_count() const { return tiles[0] * tiles[1] * tiles[2]; }
  STANDOFF_HD std::int64_t tile(std::int64_t x, std::int64_t y, std::int64_t z) const {
    return x + tiles[0] * (y + tiles[1] * z);
  }
};

inline Lattice make_lattice(const Grid& grid, double thickness) {
  Lattice l{};
  l.scale = std::ldexp(1.0, -std::ilogb(grid.max_spacing()));
  const Vec3 unit = grid.spacing * l.scale;
  const double units[3] = {unit.x, unit.y, unit.z}, origin[3] = {grid.origin.x, grid.origin.y, grid.origin.z},
               spacing[3] = {grid.spacing.x, grid.spacing.y, grid.spacing.z};
  const std::int64_t size[3] = {grid.size.x, grid.size.y, grid.size.z};
  for (int axis = 0; axis < 3; ++axis) {
    l.origin[axis] = origin[axis];
    l.spacing[axis] = spacing[axis];
    l.unit[axis] = units[axis];
    l.size[axis] = size[axis];
    l.tiles[axis] = (size[axis] + kTileSide - 1) / kTileSide;
    l.to_samples[axis] = 1 / spacing[axis];
    l.reach[axis] = thickness * l.to_samples[axis] + 2 * kBoxSlack;
    for (int n = 0; n < kBrickSide; ++n)
      l.coordinate[axis][n] = static_cast<float>((n - (kBrickSide - 1) / 2.0) * units[axis]);
  }
  l.thickness_units = thickness * l.scale;
  l.thickness = static_cast<float>(thickness * l.scale);
  l.thickness_sq = l.thickness * l.thickness;
  l.thickness_world = static_cast<float>(thickness);
  l.unscale = static_cast<float>(1 / l.scale);
  return l;
}

/// A place among the samples, in grid units: `sample` may lie between two.
STANDOFF_INLINE Triple<double> place(const Lattice& l, double x, double y, double z) {
  return {(l.origin[0] + l.spacing[0] * x) * l.scale, (l.origin[1] + l.spacing[1] * y) * l.scale,
          (l.origin[2] + l.spacing[2] * z) * l.scale};
}

/// The centre of the brick that holds tile (tx, ty, tz).
STANDOFF_INLINE Triple<double> brick_center(const Lattice& l, const std::int64_t* tile) {
  constexpr double middle = (kBrickSide - 1) / 2.0;
  return place(l, static_cast<double>((tile[0] >> 1) * kBrickSide) + middle,
               static_cast<double>((tile[1] >> 1) * kBrickSide) + middle,
               static_cast<double>((tile[2] >> 1) * kBrickSide) + middle);
}

STANDOFF_INLINE void tile_at(const Lattice& l, std::int64_t index, std::int64_t* tile) {
  tile[0] = index % l.tiles[0];
  tile[1] = index / l.tiles[0] % l.tiles[1];
  tile[2] = index / (l.tiles[0] * l.tiles[1]);
}

/// Samples of the tile inside the grid, on one axis.
STANDOFF_INLINE int inside(const Lattice& l, const std::int64_t* tile, int axis) {
  const std::int64_t left = l.size[axis] - tile[axis] * kTileSide;
  return left < kTileSide ? static_cast<int>(left) : kTileSide;
}

}  // namespace standoff::gpu
