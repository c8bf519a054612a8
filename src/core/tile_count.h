// SPDX-License-Identifier: Apache-2.0
// The size of tiles, and their number in a grid.
#pragma once

#include "standoff/field.h"

namespace standoff {

/// Samples of a tile: along an axis, and in all.
inline constexpr int kTileSide = DistanceField::kTileSide, kTileSamples = DistanceField::kTileSamples;

/// Tiles along an axis with this number of samples; the last one may be cut.
constexpr std::int64_t tiles_along(std::int64_t samples) { return DistanceField::tiles_of({samples, 1, 1}).x; }
/// Tiles of a grid. Requires a valid grid: at most 2^62 samples.
constexpr std::int64_t tile_count(const Size3& samples) {
  const Size3 tiles = DistanceField::tiles_of(samples);
  return tiles.x * tiles.y * tiles.z;
}

}  // namespace standoff
