// SPDX-License-Identifier: Apache-2.0
#include "sign/sign_field.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "core/tile_count.h"
#include "sign/cpu/kernels.h"
#include "simd/dispatch.h"

namespace standoff {

// Signs.

namespace {

// Gives a tile the signs of tile `at_rows` of the rows. `slot`: its entry in the field's slots().
void sign_tile(const InsideRows& rows, std::int64_t at_rows, const Size3& at, std::int32_t slot,
               const cpu::SignKernels& kernels, DistanceField& field) {
  if (rows.is_empty(at_rows)) return;
  const bool is_stored = slot >= 0;
  if (!is_stored && rows.is_full(at_rows)) return field.mark_inside(at.x, at.y, at.z);
  const auto values = is_stored ? field.edit_tile(at.x, at.y, at.z) : field.store_tile(at.x, at.y, at.z);
  if (!is_stored) {
    std::ranges::fill(values, static_cast<float>(field.thickness()));
    if (field.has_nearest()) std::ranges::fill(field.store_nearest(at.x, at.y, at.z), kNoTriangle);
  }
  kernels.negate(rows.tile(at_rows).data(), kTileSamples, values.data());
}

}  // namespace

void sign_field(SampleSigns& signs, bool invert, const Grid& grid, DistanceField& field, ProgressMeter& progress) {
  const cpu::SignKernels& kernels = dispatch_of<cpu::SignKernels>().best();
  const Grid& window = field.grid();
  const auto shift = [&](std::size_t axis) { return (window.first[axis] - grid.first[axis]) / kTileSide; };
  const std::int64_t shift_x = shift(0), shift_y = shift(1), shift_z = shift(2);
  const Size3 tiles = field.tile_count();
  for_each_row_of_tiles(
      signs, invert, grid, window, progress, [&](const InsideRows& inside, std::int64_t ty, std::int64_t tz) {
        const std::int64_t end = std::min(inside.end_of_tiles() - shift_x, tiles.x), y = ty - shift_y, z = tz - shift_z;
        const std::int32_t* const slots = field.slots().data() + tiles.x * (y + tiles.y * z);
        for (std::int64_t tx = std::max<std::int64_t>(0, inside.first_tile() - shift_x); tx < end; ++tx)
          sign_tile(inside, tx + shift_x, {tx, y, z}, slots[tx], kernels, field);
      });
}

void sign_values(SampleSigns& signs, bool invert, const Grid& grid, std::span<float> values, ProgressMeter& progress) {
  const cpu::SignKernels& kernels = dispatch_of<cpu::SignKernels>().best();
  PerThread<std::vector<std::uint8_t>> scratch(
      [&] { return std::vector<std::uint8_t>(static_cast<std::size_t>(tiles_along(grid.size.x))); });
  for_each_row_of_tiles(signs, invert, grid, progress, [&](const InsideRows& rows, std::int64_t ty, std::int64_t tz) {
    const std::int64_t begin = rows.first_tile(), end = rows.end_of_tiles();
    if (begin >= end) return;
    std::vector<std::uint8_t>& inside = scratch.local();
    for (int row = 0; row < InsideRows::kRows; ++row) {
      if (!rows.in_grid(row)) continue;
      for (std::int64_t tx = begin; tx < end; ++tx)
        inside[static_cast<std::size_t>(tx - begin)] = rows.tile(tx)[static_cast<std::size_t>(row)];
      // The last tile may be cut.
      kernels.negate(inside.data(), std::min(kTileSide * end, grid.size.x) - kTileSide * begin,
                     values.data() + grid.index(kTileSide * begin, kTileSide * ty + row % kTileSide,
                                                kTileSide * tz + row / kTileSide));
    }
  });
}

SampleBits bits_of(SampleSigns& signs, bool invert, const Grid& grid, ProgressMeter& progress) {
  constexpr std::int64_t kSide = InsideRows::kSide;
  SampleBits bits(grid.size);
  for_each_row_of_tiles(signs, invert, grid, progress, [&](const InsideRows& rows, std::int64_t ty, std::int64_t tz) {
    for (int row = 0; row < InsideRows::kRows; ++row) {
      if (!rows.in_grid(row)) continue;
      const std::int64_t j = kSide * ty + row % kSide, k = kSide * tz + row / kSide;
      std::uint8_t* const to = bits.bytes.data() + (k * grid.size.y + j) * bits.row_bytes();
      for (std::int64_t tx = 0; tx < bits.row_bytes(); ++tx) to[tx] = rows.tile(tx)[static_cast<std::size_t>(row)];
    }
  });
  return bits;
}

void drop_signs(DistanceField& field) {
  const Size3 tiles = field.tile_count();
  tbb::parallel_for(std::int64_t{0}, tiles.count(), [&](std::int64_t n) {
    const std::int64_t tx = n % tiles.x, ty = n / tiles.x % tiles.y, tz = n / tiles.x / tiles.y;
    if (!field.tile(tx, ty, tz)) return field.mark_outside(tx, ty, tz);
    for (float& value : field.edit_tile(tx, ty, tz)) value = std::abs(value);
  });
}

void drop_signs(std::span<float> values) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, values.size()), [&](const auto& range) {
    for (std::size_t n = range.begin(); n != range.end(); ++n) values[n] = std::abs(values[n]);
  });
}

// Shells.

namespace {

void apply_to(const Shell& shell, float& value, std::uint32_t* nearest) {
  if (nearest && shell.is_deep(value)) *nearest = kNoTriangle;
  value = shell.value(value);
}

void apply_to_tile(const Shell& shell, std::int64_t tx, std::int64_t ty, std::int64_t tz, DistanceField& field) {
  if (!field.tile(tx, ty, tz)) {
    if (shell.inverts()) field.mark_inside(tx, ty, tz);
    return;
  }
  const auto values = field.edit_tile(tx, ty, tz);
  std::uint32_t* const nearest = field.has_nearest() ? field.store_nearest(tx, ty, tz).data() : nullptr;
  const Size3& size = field.grid().size;
  const auto far = static_cast<float>(field.thickness());
  for (std::int64_t n = 0; n < DistanceField::kTileSamples; ++n) {
    const std::int64_t x = n % kTileSide, y = n / kTileSide % kTileSide, z = n / (kTileSide * kTileSide);
    const bool in_grid = kTileSide * tx + x < size.x && kTileSide * ty + y < size.y && kTileSide * tz + z < size.z;
    float& value = values[static_cast<std::size_t>(n)];
    if (in_grid)
      apply_to(shell, value, nearest ? nearest + n : nullptr);
    else
      value = far;
  }
}

// Whether all samples of a tile that are in the grid are clamped to this value.
bool is_clamped_to(float value, const DistanceField::Tile& tile, const Size3& size) {
  const std::int64_t x_end = std::min<std::int64_t>(kTileSide, size.x - kTileSide * tile.at.x),
                     y_end = std::min<std::int64_t>(kTileSide, size.y - kTileSide * tile.at.y),
                     z_end = std::min<std::int64_t>(kTileSide, size.z - kTileSide * tile.at.z);
  for (std::int64_t z = 0; z < z_end; ++z)
    for (std::int64_t y = 0; y < y_end; ++y)
      for (std::int64_t x = 0; x < x_end; ++x) {
        const auto n = static_cast<std::size_t>(x + kTileSide * (y + kTileSide * z));
        if (tile.values[n] != value || (!tile.nearest.empty() && tile.nearest[n] != kNoTriangle)) return false;
      }
  return true;
}

void drop_clamped_tiles(DistanceField& field) {
  const auto far = static_cast<float>(field.thickness());
  std::vector<Size3> outside, inside;
  for (const DistanceField::Tile& tile : field.tiles()) {
    if (is_clamped_to(far, tile, field.grid().size)) outside.push_back(tile.at);
    if (is_clamped_to(-far, tile, field.grid().size)) inside.push_back(tile.at);
  }
  field.erase_tiles(outside);
  field.erase_tiles(inside);
  for (const Size3& at : inside) field.mark_inside(at.x, at.y, at.z);
}

}  // namespace

void apply(const Shell& shell, DistanceField& field, ProgressMeter& progress) {
  const Size3 tiles = field.tile_count();
  tbb::parallel_for(tbb::blocked_range<std::int64_t>(0, tiles.y * tiles.z, 8), [&](const auto& range) {
    for (std::int64_t n = range.begin(); n != range.end(); ++n) {
      progress.check();
      for (std::int64_t tx = 0; tx < tiles.x; ++tx) apply_to_tile(shell, tx, n % tiles.y, n / tiles.y, field);
    }
  });
  drop_clamped_tiles(field);
}

void apply(const Shell& shell, std::span<float> values, std::span<std::uint32_t> nearest, ProgressMeter& progress) {
  constexpr std::size_t kGrain = std::size_t{1} << 16;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, values.size(), kGrain), [&](const auto& range) {
    progress.check();
    for (std::size_t n = range.begin(); n != range.end(); ++n)
      apply_to(shell, values[n], nearest.empty() ? nullptr : &nearest[n]);
  });
}

}  // namespace standoff
