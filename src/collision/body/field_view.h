// SPDX-License-Identifier: Apache-2.0
// A model's two distance fields as kernels read them, on the CPU and on GPUs, and how their samples are addressed.
#pragma once

#include <cstdint>

#include "geometry/host_device.h"

namespace standoff::collision {

/// A fine sample with this value is clamped: the surface is no nearer than the band's half-width.
inline constexpr int kClampedSample = 255;

/// The fields of field_bounds.h. Positions are relative to the model's middle.
struct FieldView {
  float origin[3];                        ///< of sample (0,0,0) of both grids
  float spacing, coarse_spacing;          ///< of the fine and the coarse grid
  float per_spacing, per_coarse_spacing;  ///< their reciprocals
  float last[3], coarse_last[3];          ///< the largest index per axis
  std::int32_t tiles[2];                  ///< of the fine grid along x and y
  std::int32_t coarse_size[2];            ///< of the coarse grid along x and y
  float step;                             ///< what one unit of a fine sample stands for
  float min[3], max[3];                   ///< the box of the surface
  const std::int32_t* slots;              ///< per tile: where its 512 samples start, in tiles
  const std::uint8_t* samples;
  const float* coarse;
};

/// The tile of the fine sample (i, j, k), and the sample's index in it: tiles of 8x8x8, x fastest in both.
STANDOFF_INLINE std::int32_t tile_of(const FieldView& f, std::int32_t i, std::int32_t j, std::int32_t k) {
  return ((k >> 3) * f.tiles[1] + (j >> 3)) * f.tiles[0] + (i >> 3);
}
STANDOFF_INLINE std::int32_t index_in_tile(std::int32_t i, std::int32_t j, std::int32_t k) {
  return (k & 7) << 6 | (j & 7) << 3 | (i & 7);
}
STANDOFF_INLINE std::uint8_t fine_sample(const FieldView& f, std::int32_t tile, std::int32_t index) {
  return f.samples[(static_cast<std::int64_t>(f.slots[tile]) << 9) + index];
}

STANDOFF_INLINE std::int32_t coarse_index(const FieldView& f, std::int32_t i, std::int32_t j, std::int32_t k) {
  return (k * f.coarse_size[1] + j) * f.coarse_size[0] + i;
}

}  // namespace standoff::collision
