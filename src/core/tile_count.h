// SPDX-License-Identifier: Apache-2.0
// How many tiles of samples a grid has.
#pragma once

#include "standoff/field.h"

namespace standoff {

/// Tiles along an axis of so many samples; the last one may be cut.
constexpr std::int64_t tiles_along(std::int64_t samples) {
  return (samples + DistanceField::kTileSide - 1) / DistanceField::kTileSide;
}
/// Tiles per axis.
constexpr Size3 tiles_of(const Size3& samples) {
  return {tiles_along(samples.x), tiles_along(samples.y), tiles_along(samples.z)};
}
/// Tiles of a grid. Requires a valid grid: at most 2^62 samples.
constexpr std::int64_t tile_count(const Size3& samples) {
  return tiles_along(samples.x) * tiles_along(samples.y) * tiles_along(samples.z);
}

}  // namespace standoff
