// SPDX-License-Identifier: Apache-2.0
// Counts and sizes of work on the GPU, as far as the host knows them before triangles are read: which are in range, and
// the memory that they take.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include "core/tile_count.h"
#include "field/lattice.h"
#include "field/prepare.h"
#include "field/tolerances.h"
#include "standoff/compute.h"
#include "standoff/cuda_batch.h"
#include "standoff/error.h"
#include "standoff/mesh.h"

namespace standoff {

/// Tiles that a thread of the host copies from the device one after the other: 2 MiB of values, a huge page. So threads
/// that write to new memory seldom wait for the same page.
inline constexpr std::int64_t kTilesTaken = 1024;

/// Bytes of host memory that a run takes, beside its output: slots, the tile of each slot, and pinned pieces
/// (gpu/host_copies.cuh).
inline std::int64_t host_scratch_bytes(const Grid& grid) {
  return (4 + 8) * tile_count(grid.size) + (std::int64_t{16} << 20);
}

/// Throws Error{usage} for counts that no mesh can have, and for lists that no memory can hold.
inline void check_counts(std::int64_t triangles, double thickness, std::int64_t entries) {
  constexpr std::int64_t most_entries = std::int64_t{1} << 40;
  if (triangles < 0 || static_cast<std::uint64_t>(triangles) > kMaxTriangles || entries < 0 || entries > most_entries)
    throw Error(ErrorCode::usage, "cuda: " + std::to_string(triangles) + " triangles and " + std::to_string(entries) +
                                      " list entries are out of range; give at most 4e9 and 2^40, none negative");
  if (!(thickness > 0))
    throw Error(ErrorCode::usage, "cuda: the thickness must be positive; infinity gives a full field");
}

/// Throws Error{usage} for a grid that the kernels cannot use. Requires a valid grid.
inline void check_grid(const Grid& grid) {
  if (!begins_at_brick(grid))
    throw Error(ErrorCode::usage, "cuda: a window must begin at multiples of 16 samples of its grid");
  if (!has_float_spacing(grid))
    throw Error(ErrorCode::usage, "cuda: distances would not fit into float; give spacings of other units");
}

/// Estimates the list entries of the method `tiles`, for callers who must allocate before they are counted. Thin bands:
/// small triangles lie in four or five tiles at thickness 2. Otherwise: a tile near the surface keeps the triangles in
/// it and around it, a far tile the triangles that are about equally near. The sum grows with the number of triangles
/// and, if they are smaller than tiles, with the root of triangles times tiles. The factors are fitted to full fields
/// of the scenes (terrain, machines) at 2,000 to 1,000,000 triangles.
inline std::int64_t estimate_list_entries(std::int64_t triangles, const Grid& grid, double thickness) {
  const std::int64_t tiles = tile_count(grid.size);
  if (is_thin(grid, thickness)) return 6 * triangles + 2 * tiles;
  const double mixed = 110 * std::sqrt(static_cast<double>(triangles) * static_cast<double>(tiles));
  return std::max({8 * triangles + static_cast<std::int64_t>(mixed), 48 * tiles, std::int64_t{64}});
}

/// Throws Error{usage} or Error{limit} unless counts and sizes are in range.
inline void check_sizes(const cuda::BatchTask& task) {
  validate(Grid{task.size, {}, {1, 1, 1}});
  if (task.count < 0 || task.vertex_count < 0 || task.triangle_count < 0 ||
      static_cast<std::uint64_t>(task.triangle_count) > kMaxTriangles)
    throw Error(ErrorCode::usage, "cuda: " + std::to_string(task.count) + " meshes with " +
                                      std::to_string(task.vertex_count) + " vertices and " +
                                      std::to_string(task.triangle_count) +
                                      " triangles are out of range; give no negative number, and at most 4000000000 "
                                      "triangles in all");
  if (task.count > (std::int64_t{1} << 53) / task.size.count())
    throw Error(ErrorCode::limit, "cuda: " + std::to_string(task.count) + " fields of " +
                                      std::to_string(task.size.count()) + " samples are too many; take fewer at once");
}

/// A grid with the tiles of all fields, stacked along z. Requires checked sizes.
inline Grid stacked_grid(const cuda::BatchTask& task) {
  const Size3 tiles = DistanceField::tiles_of(task.size);
  return {{tiles.x * kTileSide, tiles.y * kTileSide, tiles.z * kTileSide * task.count}, {}, {1, 1, 1}};
}

}  // namespace standoff
