#include "field/cpu/lattice.h"

#include <cmath>

namespace standoff::cpu {

Lattice make_lattice(const Grid& grid, double thickness) {
  Lattice lattice{};
  lattice.scale = std::ldexp(1.0, -std::ilogb(grid.max_spacing()));
  const Vec3 spacing = grid.spacing * lattice.scale;
  const double in_units[3] = {spacing.x, spacing.y, spacing.z};
  const double origin[3] = {grid.origin.x, grid.origin.y, grid.origin.z};
  const double world_spacing[3] = {grid.spacing.x, grid.spacing.y, grid.spacing.z};
  const std::int64_t size[3] = {grid.size.x, grid.size.y, grid.size.z};
  for (int axis = 0; axis < 3; ++axis) {
    lattice.origin[axis] = origin[axis];
    lattice.spacing[axis] = world_spacing[axis];
    lattice.size[axis] = size[axis];
    lattice.bricks[axis] = (size[axis] + kBrickSide - 1) / kBrickSide;
    lattice.inverse_spacing[axis] = static_cast<float>(1 / in_units[axis]);
  }
  lattice.thickness = static_cast<float>(thickness * lattice.scale);
  lattice.thickness_sq = lattice.thickness * lattice.thickness;
  lattice.thickness_world = static_cast<float>(thickness);

  constexpr double kMiddle = (kBrickSide - 1) / 2.0;
  const auto coordinate = [&](int sample, int axis) { return static_cast<float>((sample - kMiddle) * in_units[axis]); };
  for (int lane = 0; lane < kLanes; ++lane) {
    const int lx = lane % kBlockX, ly = lane / kBlockX % kBlockY, lz = lane / (kBlockX * kBlockY);
    for (int b = 0; b < kBlocksX; ++b) lattice.x[b][lane] = coordinate(b * kBlockX + lx, 0);
    for (int b = 0; b < kBlocksY; ++b) lattice.y[b][lane] = coordinate(b * kBlockY + ly, 1);
    for (int b = 0; b < kBlocksZ; ++b) lattice.z[b][lane] = coordinate(b * kBlockZ + lz, 2);
  }
  // Of a box of samples: its middle relative to the brick's, from its lowest sample.
  const auto middle = [&](int first, int count, int axis) {
    return static_cast<float>((first + count / 2.0 - kBrickSide / 2.0) * in_units[axis]);
  };
  const auto radius = [&](int x, int y, int z) {
    return static_cast<float>(length(spacing * Vec3{(x - 1) / 2.0, (y - 1) / 2.0, (z - 1) / 2.0}));
  };
  constexpr int kBlockSide[3] = {kBlockX, kBlockY, kBlockZ}, kClumpSide[3] = {2 * kBlockX, 4 * kBlockY, 2 * kBlockZ};
  for (int clump = 0; clump < kClumps; ++clump)
    for (int axis = 0; axis < 3; ++axis) {
      for (int lane = 0; lane < kLanes; ++lane) {
        const int block = block_of_clump(clump, lane);
        const int at[3] = {block % kBlocksX, block / kBlocksX % kBlocksY, block / (kBlocksX * kBlocksY)};
        lattice.block_centers[clump][axis][lane] = middle(at[axis] * kBlockSide[axis], kBlockSide[axis], axis);
        if (lane == 0) lattice.clump_centers[axis][clump] = middle(at[axis] * kBlockSide[axis], kClumpSide[axis], axis);
      }
    }
  lattice.block_radius = radius(kBlockX, kBlockY, kBlockZ);
  lattice.clump_radius = radius(kClumpSide[0], kClumpSide[1], kClumpSide[2]);
  return lattice;
}

Brick brick_at(const Lattice& lattice, std::int64_t index) {
  Brick brick{};
  const std::int64_t bx = lattice.bricks[0], by = lattice.bricks[1];
  const std::int64_t at[3] = {index % bx, index / bx % by, index / (bx * by)};
  for (int axis = 0; axis < 3; ++axis) {
    brick.at[axis] = at[axis];
    const double sample = static_cast<double>(at[axis] * kBrickSide) + (kBrickSide - 1) / 2.0;
    brick.center[axis] = (lattice.origin[axis] + lattice.spacing[axis] * sample) * lattice.scale;
  }
  return brick;
}

}  // namespace standoff::cpu
