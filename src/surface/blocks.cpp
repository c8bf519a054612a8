// SPDX-License-Identifier: Apache-2.0
// Finds the samples that are inside, and the blocks that the surface passes through.
#include "surface/blocks.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <utility>

#ifdef __SSE2__
#include <emmintrin.h>
#endif

#include "core/field_error.h"
#include "core/tile_count.h"

namespace standoff {
namespace {

// The least float that is not below the level: a float is below the level if and only if it is below this.
float least_float_from(double level) {
  using Limits = std::numeric_limits<float>;
  if (level > static_cast<double>(Limits::max())) return Limits::infinity();
  if (level < static_cast<double>(Limits::lowest())) return Limits::lowest();
  const auto rounded = static_cast<float>(level);
  return static_cast<double>(rounded) < level ? std::nextafter(rounded, Limits::infinity()) : rounded;
}

// A bit for each of eight values that is below the limit. Sets `has_nan` if one is NaN.
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
              "surface: the value of sample " +
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
  // The rest is for tiles that are inside and cut by the grid's end.
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

namespace {

constexpr std::uint64_t kFirstColumn = 0x0101010101010101u;

// The bits of the samples one further along x; `next`: the tile there.
std::uint64_t along_x(std::uint64_t bits, std::uint64_t next) {
  return (bits >> 1 & ~(kFirstColumn << 7)) | (next & kFirstColumn) << 7;
}
std::uint64_t along_y(std::uint64_t bits, std::uint64_t next) { return bits >> 8 | next << 56; }

// The cells of a layer with corners of both signs.
std::uint64_t crossed_cells(const CornerBits& corners, std::size_t z) {
  std::uint64_t any = 0, all = ~std::uint64_t{0};
  for (const std::size_t layer : {z, z + 1})
    for (const std::uint64_t word : corners.layers[layer]) {
      any |= word;
      all &= word;
    }
  return any & ~all;
}

bool is_crossed(const CornerBits& corners) {
  std::uint64_t cells = 0;
  for (std::size_t z = 0; z < 8; ++z) cells |= crossed_cells(corners, z);
  return cells != 0;
}

void fill(Block& block, const CornerBits& corners) {
  for (std::size_t z = 0; z < 8; ++z) {
    const auto& here = corners.layers[z];
    block.edges[0][z] = here[0] ^ here[1];
    block.edges[1][z] = here[0] ^ here[2];
    block.edges[2][z] = here[0] ^ corners.layers[z + 1][0];
    block.cells[z] = crossed_cells(corners, z);
    block.cell_rank[z] = block.cell_count;
    block.cell_count = static_cast<std::uint16_t>(block.cell_count + bit_count(block.cells[z]));
  }
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t z = 0; z < 8; ++z) {
      block.edge_rank[axis][z] = block.edge_count;
      block.edge_count = static_cast<std::uint16_t>(block.edge_count + bit_count(block.edges[axis][z]));
    }
}

}  // namespace

Blocks::Blocks(const InsideBits& inside, MemoryShare& memory, ProgressMeter& progress)
    : inside_(&inside), count_{inside.tiles().x + 1, inside.tiles().y + 1, inside.tiles().z + 1} {
  const std::int64_t rows = count_.y * count_.z;
  memory.take((static_cast<std::size_t>(rows) + 1) * sizeof first_of_row_[0]);
  first_of_row_.resize(static_cast<std::size_t>(rows) + 1);
  tbb::parallel_for(std::int64_t{0}, rows, [&](std::int64_t row) {
    progress.advance();
    std::uint32_t found = 0;
    for_each_of_row(row, [&](std::int64_t, const CornerBits&) { ++found; });
    first_of_row_[static_cast<std::size_t>(row) + 1] = found;
  });
  for (std::size_t n = 1; n < first_of_row_.size(); ++n) first_of_row_[n] += first_of_row_[n - 1];
  memory.take(first_of_row_.back() * sizeof(Block));
  blocks_.resize(first_of_row_.back());
  tbb::parallel_for(std::int64_t{0}, rows, [&](std::int64_t row) {
    std::size_t n = first_of_row_[static_cast<std::size_t>(row)];
    if (n == first_of_row_[static_cast<std::size_t>(row) + 1]) return;
    for_each_of_row(row, [&](std::int64_t x, const CornerBits& corners) {
      Block& block = blocks_[n++];
      block.at = {static_cast<std::int32_t>(x), static_cast<std::int32_t>(row % count_.y - 1),
                  static_cast<std::int32_t>(row / count_.y - 1)};
      fill(block, corners);
    });
  });
}

CornerBits Blocks::corner_bits(std::int64_t x, std::int64_t y, std::int64_t z) const {
  std::array<TileBits, 8> tile;
  for (std::size_t n = 0; n < 8; ++n)
    tile[n] = inside_->of(x + std::int64_t(n & 1), y + std::int64_t(n >> 1 & 1), z + std::int64_t(n >> 2));
  CornerBits corners;
  for (std::size_t layer = 0; layer < 9; ++layer) {
    const std::size_t first = layer < 8 ? 0 : 4;
    const auto of = [&](std::size_t n) { return tile[first + n][layer % 8]; };
    const std::uint64_t here = of(0), next_x = along_x(here, of(1));
    corners.layers[layer] = {here, next_x, along_y(here, of(2)), along_y(next_x, along_x(of(2), of(3)))};
  }
  return corners;
}

// Calls use(x, corners) for each block of a row that the surface passes through.
template <class Use>
void Blocks::for_each_of_row(std::int64_t row, const Use& use) const {
  const std::int64_t y = row % count_.y - 1, z = row / count_.y - 1;
  const std::array rows{inside_->kinds_of_row(y, z), inside_->kinds_of_row(y + 1, z), inside_->kinds_of_row(y, z + 1),
                        inside_->kinds_of_row(y + 1, z + 1)};
  constexpr std::uint8_t kBoth = InsideBits::kHasInside | InsideBits::kHasOutside;
  std::uint8_t last = InsideBits::kHasOutside;  // all is outside before the first tile
  for (std::int64_t x = -1; x + 1 < count_.x; ++x) {
    std::uint8_t next = InsideBits::kHasOutside;
    if (x + 2 < count_.x) {
      next = 0;
      for (const std::uint8_t* kinds : rows) next = static_cast<std::uint8_t>(next | kinds[x + 1]);
    }
    if ((std::exchange(last, next) | next) != kBoth) continue;
    const CornerBits corners = corner_bits(x, y, z);
    if (is_crossed(corners)) use(x, corners);
  }
}

const Block* Blocks::find(std::int64_t x, std::int64_t y, std::int64_t z) const {
  if (y < -1 || z < -1 || y + 1 >= count_.y || z + 1 >= count_.z) return nullptr;
  const auto row = static_cast<std::size_t>(y + 1 + count_.y * (z + 1));
  const auto begin = blocks_.begin() + first_of_row_[row], end = blocks_.begin() + first_of_row_[row + 1];
  const auto found =
      std::lower_bound(begin, end, x, [](const Block& block, std::int64_t at) { return block.at[0] < at; });
  return found != end && found->at[0] == x ? &*found : nullptr;
}

std::array<const Block*, 8> Blocks::beside(const Block& block, int step) const {
  std::array<const Block*, 8> found;
  for (std::size_t n = 0; n < 8; ++n) {
    const auto along = [&](std::size_t axis) { return block.at[axis] + step * std::int64_t(n >> axis & 1); };
    found[n] = n == 0 ? &block : find(along(0), along(1), along(2));
  }
  return found;
}

}  // namespace standoff
