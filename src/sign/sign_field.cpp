// SPDX-License-Identifier: Apache-2.0
#include "sign/sign_field.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#include "core/per_thread.h"
#include "core/tile_count.h"

namespace standoff {
namespace {

constexpr int kSide = DistanceField::kTileSide, kSamples = DistanceField::kTileSamples;

// Zero stays zero: a sample on the surface has no side.
float negated(float value, bool inside) { return inside && value != 0 ? -value : value; }

// Calls use(rows, ty, tz) for each row of tiles.
template <class Use>
void for_each_row_of_tiles(const Sides& sides, bool invert, const Grid& grid, ProgressMeter& progress, const Use& use) {
  PerThread<InsideRows> scratch([&] { return InsideRows(grid); });
  const std::int64_t tiles_y = tiles_along(grid.size.y), rows_of_tiles = tiles_y * tiles_along(grid.size.z);
  tbb::parallel_for(tbb::blocked_range<std::int64_t>(0, rows_of_tiles, 8), [&](const auto& range) {
    progress.check();
    InsideRows& rows = scratch.local();
    for (std::int64_t n = range.begin(); n != range.end(); ++n) {
      const std::int64_t ty = n % tiles_y, tz = n / tiles_y;
      rows.clear(ty, tz);
      sides.fill(rows, ty, tz);
      if (invert) rows.invert();
      use(rows, ty, tz);
    }
  });
}

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
