// SPDX-License-Identifier: Apache-2.0
#include "surface/inside_bits.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#ifdef __SSE2__
#include <emmintrin.h>
#endif

#include "core/field_error.h"
#include "core/tile_count.h"

namespace standoff {
namespace {

// A float is below the level where, and only where, it is below the least float that is not.
float least_float_from(double level) {
  using Limits = std::numeric_limits<float>;
  if (level > static_cast<double>(Limits::max())) return Limits::infinity();
  if (level < static_cast<double>(Limits::lowest())) return Limits::lowest();
  const auto rounded = static_cast<float>(level);
  return static_cast<double>(rounded) < level ? std::nextafter(rounded, Limits::infinity()) : rounded;
}

// The bits of eight values that are below the limit. Sets `has_nan` if one is not a number.
#ifdef __SSE2__
std::uint64_t bits_of_row(const float* values, float limit, bool& has_nan) {
  const __m128 low = _mm_loadu_ps(values), high = _mm_loadu_ps(values + 4), all = _mm_set1_ps(limit);
  has_nan |= _mm_movemask_ps(_mm_cmpunord_ps(low, high)) != 0;
  const auto masks = [](__m128 a, __m128 b) {
    return static_cast<std::uint64_t>(_mm_movemask_ps(a) | _mm_movemask_ps(b) << 4);
  };
  return masks(_mm_cmplt_ps(low, all), _mm_cmplt_ps(high, all));
}
#else
std::uint64_t bits_of_row(const float* values, float limit, bool& has_nan) {
  std::uint64_t bits = 0;
  for (int n = 0; n < kTileSide; ++n) {
    bits |= std::uint64_t{values[n] < limit} << n;
    has_nan |= std::isnan(values[n]);
  }
  return bits;
}
#endif

TileBits bits_of(DistanceField::TileValues values, float limit, bool& has_nan) {
  TileBits bits{};
  for (std::size_t z = 0; z < kTileSide; ++z)
    for (std::size_t y = 0; y < kTileSide; ++y)
      bits[z] |= bits_of_row(&values[8 * (y + 8 * z)], limit, has_nan) << 8 * y;
  return bits;
}

[[noreturn]] void fail_not_a_number(const DistanceField& field, std::int64_t index) {
  const Size3 n = field.tile_count();
  const std::int64_t tx = index % n.x, ty = index / n.x % n.y, tz = index / (n.x * n.y);
  const auto values = *field.tile(tx, ty, tz);
  const auto at = std::find_if(values.begin(), values.end(), [](float v) { return std::isnan(v); }) - values.begin();
  throw Error(ErrorCode::input,
              "isosurface: the value of sample " +
                  index_text(kTileSide * tx + at % 8, kTileSide * ty + at / 8 % 8, kTileSide * tz + at / 64) +
                  " is not a number; compute the field again, or repair it");
}

}  // namespace

std::size_t InsideBits::bytes_for(const DistanceField& field) {
  const Size3 tiles = field.tile_count();
  return sizeof(TileBits) * static_cast<std::size_t>(field.stored_tiles()) +
         static_cast<std::size_t>(tiles.count() + tiles.x);
}

InsideBits::InsideBits(const DistanceField& field, double level, ProgressMeter& progress)
    : field_(&field),
      tiles_(field.tile_count()),
      bits_(static_cast<std::size_t>(field.stored_tiles())),
      kinds_(static_cast<std::size_t>(tiles_.count()), kHasOutside),
      outside_(static_cast<std::size_t>(tiles_.x), kHasOutside) {
  const std::span<const std::int32_t> slots = field.slots();
  if (slots.empty()) return;
  const std::span<const float> values = field.tile_values();
  const float limit = least_float_from(level);
  constexpr std::int64_t kNoTile = std::numeric_limits<std::int64_t>::max();
  std::atomic<std::int64_t> not_a_number{kNoTile};
  tbb::parallel_for(std::int64_t{0}, tiles_.y * tiles_.z, [&](std::int64_t row) {
    progress.advance();
    const std::int64_t ty = row % tiles_.y, tz = row / tiles_.y;
    for (std::int64_t tx = 0; tx < tiles_.x; ++tx) {
      const auto index = static_cast<std::size_t>(tx + tiles_.x * row);
      const std::int32_t slot = slots[index];
      if (slot == DistanceField::kInside) kinds_[index] = kHasInside;
      if (slot < 0) continue;
      bool has_nan = false;
      const auto s = static_cast<std::size_t>(slot);
      TileBits bits =
          bits_of(values.subspan(s * DistanceField::kTileSamples).first<DistanceField::kTileSamples>(), limit, has_nan);
      const TileBits grid = samples_of_grid(tx, ty, tz);
      if (has_nan) {
        std::int64_t first = not_a_number;
        while (std::int64_t(index) < first && !not_a_number.compare_exchange_weak(first, std::int64_t(index))) {
        }
      }
      std::uint64_t any = 0, all = ~std::uint64_t{0};
      for (std::size_t z = 0; z < kTileSide; ++z) {
        bits[z] &= grid[z];
        any |= bits[z];
        all &= bits[z];
      }
      kinds_[index] = static_cast<std::uint8_t>((any != 0 ? kHasInside : 0) | (~all != 0 ? kHasOutside : 0));
      bits_[s] = bits;
    }
  });
  if (not_a_number != kNoTile) fail_not_a_number(field, not_a_number);
  // Of tiles inside that the grid ends in.
  if (std::ranges::find(slots, DistanceField::kInside) == slots.end()) return;
  for (std::size_t index = 0; index < slots.size(); ++index)
    if (slots[index] == DistanceField::kInside) {
      const auto n = static_cast<std::int64_t>(index);
      const TileBits grid = samples_of_grid(n % tiles_.x, n / tiles_.x % tiles_.y, n / (tiles_.x * tiles_.y));
      for (const std::uint64_t word : grid)
        if (~word != 0) kinds_[index] = kHasInside | kHasOutside;
    }
}

TileBits InsideBits::samples_of_grid(std::int64_t tx, std::int64_t ty, std::int64_t tz) const {
  const Size3& n = field_->grid().size;
  const auto within = [](std::int64_t samples, std::int64_t tile) {
    return static_cast<int>(std::min<std::int64_t>(kTileSide, samples - kTileSide * tile));
  };
  const int nx = within(n.x, tx), ny = within(n.y, ty), nz = within(n.z, tz);
  std::uint64_t word = (0x0101010101010101u << nx) - 0x0101010101010101u;  // bits 0 to nx - 1 of each byte
  if (nx == kTileSide) word = ~std::uint64_t{0};
  if (ny < kTileSide) word &= (std::uint64_t{1} << 8 * ny) - 1;
  TileBits bits{};
  std::fill_n(bits.begin(), nz, word);
  return bits;
}

TileBits InsideBits::of(std::int64_t tx, std::int64_t ty, std::int64_t tz) const {
  const std::span<const std::int32_t> slots = field_->slots();
  if (!is_tile(tx, ty, tz) || slots.empty()) return {};
  const std::int32_t slot = slots[static_cast<std::size_t>(tx + tiles_.x * (ty + tiles_.y * tz))];
  if (slot >= 0) return bits_[static_cast<std::size_t>(slot)];
  return slot == DistanceField::kInside ? samples_of_grid(tx, ty, tz) : TileBits{};
}

const std::uint8_t* InsideBits::kinds_of_row(std::int64_t ty, std::int64_t tz) const {
  if (!is_tile(0, ty, tz)) return outside_.data();
  return kinds_.data() + tiles_.x * (ty + tiles_.y * tz);
}

}  // namespace standoff
