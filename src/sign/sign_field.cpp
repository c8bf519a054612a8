// SPDX-License-Identifier: Apache-2.0
#include "sign/sign_field.h"

#include <algorithm>

#include "core/tile_count.h"
#include "sign/each_row_of_tiles.h"

namespace standoff {
namespace {

constexpr int kSide = DistanceField::kTileSide, kSamples = DistanceField::kTileSamples;

// Zero stays zero: a sample on the surface has no side.
float negated(float value, bool inside) { return inside && value != 0 ? -value : value; }

void negate_inside(std::span<const std::uint8_t, 64> inside, std::span<float, kSamples> values) {
  for (std::size_t row = 0; row < inside.size(); ++row) {
    if (inside[row] == 0) continue;
    for (std::size_t x = 0; x < kSide; ++x) {
      float& value = values[kSide * row + x];
      value = negated(value, (inside[row] >> x & 1) != 0);
    }
  }
}

void sign_tile(const InsideRows& rows, std::int64_t tx, std::int64_t ty, std::int64_t tz, DistanceField& field) {
  const std::span<const std::uint8_t, 64> inside = rows.tile(tx);
  if (rows.is_empty(tx)) return;
  if (field.tile(tx, ty, tz)) return negate_inside(inside, field.edit_tile(tx, ty, tz));
  if (rows.is_full(tx)) return field.mark_inside(tx, ty, tz);
  const std::span<float, kSamples> values = field.store_tile(tx, ty, tz);
  std::ranges::fill(values, static_cast<float>(field.thickness()));
  if (field.has_nearest()) std::ranges::fill(field.store_nearest(tx, ty, tz), kNoTriangle);
  negate_inside(inside, values);
}

}  // namespace

void sign_field(const Sides& sides, bool invert, DistanceField& field, ProgressMeter& progress) {
  const std::int64_t tiles_x = tiles_along(field.grid().size.x);
  for_each_row_of_tiles(sides, invert, field.grid(), progress,
                        [&](const InsideRows& rows, std::int64_t ty, std::int64_t tz) {
                          for (std::int64_t tx = 0; tx < tiles_x; ++tx) sign_tile(rows, tx, ty, tz, field);
                        });
}

void sign_values(const Sides& sides, bool invert, const Grid& grid, std::span<float> values, ProgressMeter& progress) {
  for_each_row_of_tiles(sides, invert, grid, progress, [&](const InsideRows& rows, std::int64_t ty, std::int64_t tz) {
    for (int row = 0; row < InsideRows::kRows; ++row) {
      if (!rows.in_grid(row)) continue;
      const auto first = static_cast<std::size_t>(grid.index(0, kSide * ty + row % kSide, kSide * tz + row / kSide));
      for (std::int64_t i = 0; i < grid.size.x; ++i) {
        float& value = values[first + static_cast<std::size_t>(i)];
        value = negated(value, rows.is_inside(row, i));
      }
    }
  });
}

}  // namespace standoff
