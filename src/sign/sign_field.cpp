// SPDX-License-Identifier: Apache-2.0
#include "sign/sign_field.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>

#include "core/tile_count.h"
#include "sign/each_row_of_tiles.h"

namespace standoff {
namespace {

constexpr int kSide = DistanceField::kTileSide, kSamples = DistanceField::kTileSamples;

using FourUints = std::uint32_t __attribute__((vector_size(16)));

// Negates the values of those of eight samples that are inside. Zero stays zero: a sample on the surface has no side.
void negate(std::uint8_t inside, float* values) {
  constexpr std::array<FourUints, 2> bit{FourUints{1, 2, 4, 8}, FourUints{16, 32, 64, 128}};
  const FourUints all = FourUints{} + inside;
  for (std::size_t half = 0; half < 2; ++half) {
    FourUints four;
    std::memcpy(&four, values + 4 * half, sizeof four);
    const FourUints changes = ((all & bit[half]) != 0) & ((four << 1) != 0);
    four ^= changes << 31;
    std::memcpy(values + 4 * half, &four, sizeof four);
  }
}

void negate_inside(std::span<const std::uint8_t, 64> inside, std::span<float, kSamples> values) {
  for (std::size_t row = 0; row < inside.size(); ++row)
    if (inside[row] != 0) negate(inside[row], values.data() + kSide * row);
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

void sign_field(Sides& sides, bool invert, DistanceField& field, ProgressMeter& progress) {
  for_each_row_of_tiles(sides, invert, field.grid(), progress,
                        [&](const InsideRows& rows, std::int64_t ty, std::int64_t tz) {
                          for (std::int64_t tx = rows.first_tile(); tx < rows.end_of_tiles(); ++tx)
                            sign_tile(rows, tx, ty, tz, field);
                        });
}

void sign_values(Sides& sides, bool invert, const Grid& grid, std::span<float> values, ProgressMeter& progress) {
  for_each_row_of_tiles(sides, invert, grid, progress, [&](const InsideRows& rows, std::int64_t ty, std::int64_t tz) {
    for (int row = 0; row < InsideRows::kRows; ++row) {
      if (!rows.in_grid(row)) continue;
      const auto first = static_cast<std::size_t>(grid.index(0, kSide * ty + row % kSide, kSide * tz + row / kSide));
      for (std::int64_t tx = rows.first_tile(); tx < rows.end_of_tiles(); ++tx) {
        const std::uint8_t inside = rows.tile(tx)[static_cast<std::size_t>(row)];
        if (inside == 0) continue;
        // The last tile may be cut.
        const auto here =
            values.subspan(first + static_cast<std::size_t>(kSide * tx),
                           static_cast<std::size_t>(std::min<std::int64_t>(kSide, grid.size.x - kSide * tx)));
        std::array<float, kSide> eight{};
        if (here.size() == kSide) {
          negate(inside, here.data());
        } else {
          std::ranges::copy(here, eight.begin());
          negate(inside, eight.data());
          std::copy_n(eight.begin(), here.size(), here.begin());
        }
      }
    }
  });
}

}  // namespace standoff
