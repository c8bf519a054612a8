// SPDX-License-Identifier: Apache-2.0
// The sizes of a task of many meshes (standoff/cuda_batch.h), as far as the host knows them.
#pragma once

#include <cstdint>
#include <string>

#include "core/tile_count.h"
#include "standoff/cuda_batch.h"
#include "standoff/error.h"
#include "standoff/mesh.h"

namespace standoff {

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
