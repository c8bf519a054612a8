// SPDX-License-Identifier: Apache-2.0
#include "surface/inside_bits.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <limits>

#include "core/field_error.h"

namespace standoff {
namespace {

constexpr int kSide = DistanceField::kTileSide;

// A float is below the level where, and only where, it is below the least float that is not.
float least_float_from(double level) {
  const auto rounded = static_cast<float>(level);
  return static_cast<double>(rounded) < level ? std::nextafter(rounded, std::numeric_limits<float>::infinity())
                                              : rounded;
}

// Sets `has_nan` if a value is not a number. Comparisons of a whole row become eight bytes of 0 or 1, and the product
// moves them into the eight bits of one.
TileBits bits_of(DistanceField::TileValues values, float limit, bool& has_nan) {
  constexpr std::uint64_t kGather = 0x0102040810204080u;
  std::array<std::uint8_t, DistanceField::kTileSamples> below;
  std::uint8_t nan = 0;
  for (std::size_t n = 0; n < below.size(); ++n) {
    below[n] = values[n] < limit;
    nan = static_cast<std::uint8_t>(nan | (values[n] != values[n]));
  }
  has_nan = nan != 0;
  TileBits bits{};
  for (std::size_t row = 0; row < kSide * kSide; ++row) {
    std::array<std::uint8_t, 8> bytes;
    std::copy_n(below.begin() + static_cast<std::ptrdiff_t>(8 * row), 8, bytes.begin());
    auto word = std::bit_cast<std::uint64_t>(bytes);
    if constexpr (std::endian::native == std::endian::big) word = __builtin_bswap64(word);
    bits[row / kSide] |= (word * kGather >> 56) << 8 * (row % kSide);
  }
  return bits;
}

[[noreturn]] void fail_not_a_number(const DistanceField& field, std::int64_t index) {
  const Size3 n = field.tile_count();
  const std::int64_t tx = index % n.x, ty = index / n.x % n.y, tz = index / (n.x * n.y);
  const auto values = *field.tile(tx, ty, tz);
  const auto at = std::find_if(values.begin(), values.end(), [](float v) { return std::isnan(v); }) - values.begin();
  throw Error(ErrorCode::input, "isosurface: the value of sample " +
                                    index_text(kSide * tx + at % 8, kSide * ty + at / 8 % 8, kSide * tz + at / 64) +
                                    " is not a number; compute the field again, or repair it");
}

}  // namespace

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
      TileBits bits = bits_of(values.subspan(s * DistanceField::kTileSamples).first<DistanceField::kTileSamples>(),
                              limit, has_nan);
      const TileBits grid = samples_of_grid(tx, ty, tz);
      if (has_nan) {
        std::int64_t first = not_a_number;
        while (std::int64_t(index) < first && !not_a_number.compare_exchange_weak(first, std::int64_t(index))) {
        }
      }
      std::uint64_t any = 0, all = ~std::uint64_t{0};
      for (std::size_t z = 0; z < kSide; ++z) {
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
    return static_cast<int>(std::min<std::int64_t>(kSide, samples - kSide * tile));
  };
  const int nx = within(n.x, tx), ny = within(n.y, ty), nz = within(n.z, tz);
  std::uint64_t word = (0x0101010101010101u << nx) - 0x0101010101010101u;  // bits 0 to nx - 1 of each byte
  if (nx == kSide) word = ~std::uint64_t{0};
  if (ny < kSide) word &= (std::uint64_t{1} << 8 * ny) - 1;
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
