// SPDX-License-Identifier: Apache-2.0
// The values of the samples in and around a block.
#pragma once

#include <array>
#include <cstdint>
#include <limits>

#include "standoff/field.h"

namespace standoff {

/// The values of tiles that are not stored.
class UniformTiles {
 public:
  explicit UniformTiles(double thickness) {
    outside_.fill(static_cast<float>(thickness));
    inside_.fill(static_cast<float>(-thickness));
    beyond_.fill(std::numeric_limits<float>::infinity());
  }
  const float* of(std::int32_t slot) const { return slot == DistanceField::kInside ? inside_.data() : outside_.data(); }
  const float* beyond_grid() const { return beyond_.data(); }

 private:
  using Tile = std::array<float, DistanceField::kTileSamples>;
  Tile outside_, inside_, beyond_;
};

/// A block and all blocks around it.
class Neighbourhood {
 public:
  /// Both arguments outlive this.
  Neighbourhood(const DistanceField& field, const UniformTiles& uniform, const std::array<std::int32_t, 3>& at)
      : size_(field.grid().size), first_{8 * std::int64_t{at[0]}, 8 * std::int64_t{at[1]}, 8 * std::int64_t{at[2]}} {
    const Size3 tiles = field.tile_count();
    const auto slots = field.slots();
    const float* const values = field.tile_values().data();
    std::size_t n = 0;
    for (std::int64_t z = at[2] - 1; z <= at[2] + 1; ++z)
      for (std::int64_t y = at[1] - 1; y <= at[1] + 1; ++y)
        for (std::int64_t x = at[0] - 1; x <= at[0] + 1; ++x, ++n) {
          const bool is_tile = x >= 0 && y >= 0 && z >= 0 && x < tiles.x && y < tiles.y && z < tiles.z;
          if (!is_tile || slots.empty()) {
            tile_[n] = uniform.beyond_grid();
            continue;
          }
          const std::int32_t slot = slots[static_cast<std::size_t>(x + tiles.x * (y + tiles.y * z))];
          tile_[n] = slot < 0 ? uniform.of(slot) : values + std::int64_t{DistanceField::kTileSamples} * slot;
        }
    at_border_ = first_.x + 16 > size_.x || first_.y + 16 > size_.y || first_.z + 16 > size_.z;
  }

  /// The value of a sample, counted from the block's first one: from -8 to 15 along each axis. Beyond the grid it is
  /// +infinity.
  float value(int x, int y, int z) const {
    if (at_border_ && !is_sample(x, y, z)) return std::numeric_limits<float>::infinity();
    const int tile = ((x + 8) >> 3) + 3 * (((y + 8) >> 3) + 3 * ((z + 8) >> 3));
    return tile_[static_cast<std::size_t>(tile)][(x & 7) + 8 * (y & 7) + 64 * (z & 7)];
  }
  /// Whether an edge of the block may have an end beyond the grid.
  bool leaves_grid() const { return at_border_ || first_.x < 0 || first_.y < 0 || first_.z < 0; }
  bool is_sample(int x, int y, int z) const {
    const std::int64_t i = first_.x + x, j = first_.y + y, k = first_.z + z;
    return i >= 0 && j >= 0 && k >= 0 && i < size_.x && j < size_.y && k < size_.z;
  }

 private:
  Size3 size_, first_;
  std::array<const float*, 27> tile_;
  bool at_border_ = false;
};

}  // namespace standoff
