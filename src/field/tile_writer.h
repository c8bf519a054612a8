// SPDX-License-Identifier: Apache-2.0
// Where a backend puts finished tiles: the sparse tiles of a DistanceField, or the caller's dense memory.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>

#include "standoff/field.h"

namespace standoff {

/// Memory for the samples of one tile: sample (x,y,z) of the tile is at values[x + row * y + slice * z].
/// Only `size` samples per axis may be written: tiles at the far faces of a dense grid are cut.
struct TileTarget {
  float* values = nullptr;
  std::uint32_t* nearest = nullptr;  ///< nullptr when nearest triangles are not asked for
  std::int64_t row = 0;
  std::int64_t slice = 0;
  Size3 size;
};

/// Backends call `open` once for each tile with a band sample (distance <= thickness), from any thread, and write
/// every sample of it. Tiles never opened read as the thickness, without a nearest triangle.
class Sink {
 public:
  /// Tiles go into `field`, whose first layer of tiles is layer `first_layer` of the grid that is filled.
  explicit Sink(DistanceField& field, std::int64_t first_layer = 0)
      : grid_(field.grid()), field_(&field), first_layer_(first_layer), with_nearest_(field.has_nearest()) {}
  /// Tiles go into dense memory, which the caller has filled with the thickness and kNoTriangle.
  Sink(const Grid& grid, std::span<float> values, std::span<std::uint32_t> nearest)
      : grid_(grid), values_(values.data()), nearest_(nearest.data()), with_nearest_(!nearest.empty()) {}

  bool with_nearest() const { return with_nearest_; }

  TileTarget open(std::int64_t tx, std::int64_t ty, std::int64_t tz) {
    constexpr std::int64_t side = DistanceField::kTileSide;
    if (field_) {
      const std::int64_t in_field = tz - first_layer_;
      TileTarget target{field_->store_tile(tx, ty, in_field).data(), nullptr, side, side * side, {side, side, side}};
      if (with_nearest_) target.nearest = field_->store_nearest(tx, ty, in_field).data();
      return target;
    }
    const std::int64_t x = tx * side, y = ty * side, z = tz * side, at = grid_.index(x, y, z);
    const Size3& n = grid_.size;
    return {values_ + at,
            with_nearest_ ? nearest_ + at : nullptr,
            n.x,
            n.x * n.y,
            {std::min(side, n.x - x), std::min(side, n.y - y), std::min(side, n.z - z)}};
  }

 private:
  const Grid& grid_;
  DistanceField* field_ = nullptr;
  std::int64_t first_layer_ = 0;
  float* values_ = nullptr;
  std::uint32_t* nearest_ = nullptr;
  bool with_nearest_ = false;
};

}  // namespace standoff
