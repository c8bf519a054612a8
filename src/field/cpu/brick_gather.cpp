// SPDX-License-Identifier: Apache-2.0
#include "field/cpu/brick_gather.h"

#include <limits>

namespace standoff::cpu {
namespace {

// Forgets the samples past the grid's far faces, so that stored tiles hold the thickness there.
void clear_outside(const BlockLattice& lattice, const Brick& brick, bool with_nearest, BrickState& state) {
  int size[3];
  for (int axis = 0; axis < 3; ++axis) size[axis] = inside<kBrickSide>(lattice, brick.at, axis);
  for (int z = 0; z < kBrickSide; ++z)
    for (int y = 0; y < kBrickSide; ++y)
      for (int x = z < size[2] && y < size[1] ? size[0] : 0; x < kBrickSide; ++x) {
        const int block = block_index(x / kBlockX, y / kBlockY, z / kBlockZ);
        const int lane = x % kBlockX + kBlockX * (y % kBlockY + kBlockY * (z % kBlockZ));
        state.distance_sq[block][lane] = std::numeric_limits<float>::infinity();
        if (with_nearest) state.nearest[block][lane] = kNoTriangle;
      }
}

}  // namespace

Candidates candidates_of(const Job& job, std::span<const std::uint32_t> refs) {
  return {memory_of(job.mesh), refs.data(), static_cast<std::int64_t>(refs.size())};
}

void write_brick(const BlockLattice& lattice, const Brick& brick, const Kernels& kernels, BrickState& state,
                 Sink& sink) {
  const unsigned tiles = kernels.band_tiles(lattice, brick, state);
  if (tiles != 0) clear_outside(lattice, brick, sink.with_nearest(), state);
  for (int tile = 0; tile < kBrickTiles; ++tile)
    if (tiles >> tile & 1)
      kernels.write_tile(
          lattice, state, tile,
          sink.open(2 * brick.at[0] + (tile & 1), 2 * brick.at[1] + (tile >> 1 & 1), 2 * brick.at[2] + (tile >> 2)));
}

}  // namespace standoff::cpu
