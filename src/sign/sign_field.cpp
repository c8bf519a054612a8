// SPDX-License-Identifier: Apache-2.0
#include "sign/sign_field.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>

#include "core/tile_count.h"

namespace standoff {
namespace {

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

void negate_inside(std::span<const std::uint8_t, 64> inside, std::span<float, kTileSamples> values) {
  for (std::size_t row = 0; row < inside.size(); ++row)
    if (inside[row] != 0) negate(inside[row], values.data() + kTileSide * row);
}

// Gives the tiles of a row of tiles their signs.
class TileSigns {
 public:
  TileSigns(const InsideRows& rows, std::int64_t ty, std::int64_t tz, DistanceField& field)
      : rows_(rows), ty_(ty), tz_(tz), field_(field) {}

  void add(std::int64_t tx) {
    if (rows_.is_empty(tx)) return;
    if (field_.tile(tx, ty_, tz_)) return take(tx);
    if (rows_.is_full(tx)) return field_.mark_inside(tx, ty_, tz_);
    const std::span<float, kTileSamples> values = field_.store_tile(tx, ty_, tz_);
    std::ranges::fill(values, static_cast<float>(field_.thickness()));
    if (field_.has_nearest()) std::ranges::fill(field_.store_nearest(tx, ty_, tz_), kNoTriangle);
    negate_inside(rows_.tile(tx), values);
  }
  // The last tile waits until it is called.
  void finish() {
    if (waiting_) negate_inside(rows_.tile(tx_), std::span<float, kTileSamples>(waiting_, kTileSamples));
    waiting_ = nullptr;
  }

 private:
  // Tiles are far from each other in memory: while one is negated the next one is fetched.
  void take(std::int64_t tx) {
    float* const values = field_.edit_tile(tx, ty_, tz_).data();
    for (int n = 0; n < kTileSamples; n += 16) __builtin_prefetch(values + n, 1);
    finish();
    waiting_ = values;
    tx_ = tx;
  }

  const InsideRows& rows_;
  std::int64_t ty_, tz_;
  DistanceField& field_;
  float* waiting_ = nullptr;
  std::int64_t tx_ = 0;
};

}  // namespace

void sign_field(Sides& sides, bool invert, DistanceField& field, ProgressMeter& progress) {
  RowsOfTiles rows(sides, invert, field.grid(), progress);
  sign_slab(rows, 0, field);
}

void sign_slab(RowsOfTiles& rows, std::int64_t first_layer, DistanceField& slab) {
  rows.next_layers(slab.tile_count().z, [&](const InsideRows& inside, std::int64_t ty, std::int64_t tz) {
    TileSigns signs(inside, ty, tz - first_layer, slab);
    for (std::int64_t tx = inside.first_tile(); tx < inside.end_of_tiles(); ++tx) signs.add(tx);
    signs.finish();
  });
}

void sign_values(Sides& sides, bool invert, const Grid& grid, std::span<float> values, ProgressMeter& progress) {
  for_each_row_of_tiles(sides, invert, grid, progress, [&](const InsideRows& rows, std::int64_t ty, std::int64_t tz) {
    for (int row = 0; row < InsideRows::kRows; ++row) {
      if (!rows.in_grid(row)) continue;
      const auto first =
          static_cast<std::size_t>(grid.index(0, kTileSide * ty + row % kTileSide, kTileSide * tz + row / kTileSide));
      for (std::int64_t tx = rows.first_tile(); tx < rows.end_of_tiles(); ++tx) {
        const std::uint8_t inside = rows.tile(tx)[static_cast<std::size_t>(row)];
        if (inside == 0) continue;
        // The last tile may be cut.
        const auto here =
            values.subspan(first + static_cast<std::size_t>(kTileSide * tx),
                           static_cast<std::size_t>(std::min<std::int64_t>(kTileSide, grid.size.x - kTileSide * tx)));
        std::array<float, kTileSide> eight{};
        if (here.size() == kTileSide) {
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
