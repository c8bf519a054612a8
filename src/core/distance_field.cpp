// SPDX-License-Identifier: Apache-2.0
// Fields: the storage of tiles, conversion to dense memory and back, and a summary of the values.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <utility>

#include "core/field_error.h"
#include "core/guarded.h"
#include "core/memory.h"
#include "core/tile_count.h"
#include "standoff/field.h"
#include "standoff/inspect.h"

namespace standoff {
namespace {

constexpr int within(std::int64_t i, std::int64_t j, std::int64_t k) {
  return static_cast<int>((i % kTileSide) + kTileSide * ((j % kTileSide) + kTileSide * (k % kTileSide)));
}

bool is_one_of(std::int64_t n, std::int64_t count) { return n >= 0 && n < count; }

}  // namespace

DistanceField::DistanceField(const Grid& grid, double thickness, bool with_nearest) {
  reset(grid, thickness, with_nearest);
}

void DistanceField::reset(const Grid& grid, double thickness, bool with_nearest) try {
  validate(grid);
  if (!(thickness > 0))
    throw Error(ErrorCode::usage, "field: the thickness must be positive; infinity gives a full field");
  const std::int64_t tiles = standoff::tile_count(grid.size);
  if (tiles > std::numeric_limits<std::int32_t>::max())
    throw Error(ErrorCode::limit, "field: " + std::to_string(tiles) + " tiles are more than 2^31; take fewer samples");
  // Take the pool away first: if memory runs out before the end, the field has no tiles.
  std::unique_ptr<TilePool> pool = std::exchange(pool_, nullptr);
  if (!pool) pool = std::make_unique<TilePool>();
  provenance_ = {};
  grid_ = grid;
  thickness_ = thickness;
  with_nearest_ = with_nearest;
  slots_.assign(static_cast<std::size_t>(tiles), kOutside);
  pool->clear(tiles, with_nearest);
  pool_ = std::move(pool);
} catch (...) {
  if (!pool_) slots_.clear();
  throw_field_error();
}

DistanceField::DistanceField() = default;
DistanceField::~DistanceField() = default;

DistanceField::DistanceField(DistanceField&& other) noexcept { *this = std::move(other); }

DistanceField& DistanceField::operator=(DistanceField&& other) noexcept {
  // Reset each member of `other` to the value of a new field. This also works if a field is assigned to itself.
  provenance_ = std::exchange(other.provenance_, {});
  grid_ = std::exchange(other.grid_, kEmptyGrid);
  thickness_ = std::exchange(other.thickness_, kEmptyThickness);
  with_nearest_ = std::exchange(other.with_nearest_, false);
  slots_ = std::exchange(other.slots_, {});
  pool_ = std::exchange(other.pool_, nullptr);
  return *this;
}

DistanceField::DistanceField(const DistanceField& other) try
    : provenance_(other.provenance_),
      grid_(other.grid_),
      thickness_(other.thickness_),
      with_nearest_(other.with_nearest_),
      slots_(other.slots_) {
  if (!other.pool_) return;
  pool_ = std::make_unique<TilePool>();
  pool_->clear(std::ssize(slots_), with_nearest_);
  pool_->copy_from(*other.pool_);
} catch (...) {
  throw_field_error();
}

DistanceField& DistanceField::operator=(const DistanceField& other) try {
  if (this != &other) *this = DistanceField(other);
  return *this;
} catch (...) {
  throw_field_error();
}

Size3 DistanceField::tile_count() const { return tiles_of(grid_.size); }

std::int64_t DistanceField::stored_tiles() const { return pool_ ? pool_->size() : 0; }

std::int64_t DistanceField::tile_index(std::int64_t tx, std::int64_t ty, std::int64_t tz) const {
  const Size3 n = tile_count();
  if (!is_one_of(tx, n.x) || !is_one_of(ty, n.y) || !is_one_of(tz, n.z))
    fail_field([=] { return "there is no tile " + index_text(tx, ty, tz) + "; ask for one of tile_count()"; });
  return tx + n.x * (ty + n.y * tz);
}

std::int32_t DistanceField::slot_of(std::int64_t tx, std::int64_t ty, std::int64_t tz) const {
  const std::int64_t index = tile_index(tx, ty, tz);
  return slots_.empty() ? kOutside : slots_[static_cast<std::size_t>(index)];
}

float DistanceField::background_of(std::int32_t slot) const {
  return static_cast<float>(slot == kInside ? -thickness_ : thickness_);
}

void DistanceField::expect_sample(std::int64_t i, std::int64_t j, std::int64_t k) const {
  const Size3& n = grid_.size;
  if (!is_one_of(i, n.x) || !is_one_of(j, n.y) || !is_one_of(k, n.z))
    fail_field([=] { return "there is no sample " + index_text(i, j, k) + "; ask for one of grid()"; });
}

float DistanceField::value(std::int64_t i, std::int64_t j, std::int64_t k) const {
  expect_sample(i, j, k);
  const std::int32_t slot = slot_of(i / kTileSide, j / kTileSide, k / kTileSide);
  return slot >= 0 ? pool_->values(slot)[within(i, j, k)] : background_of(slot);
}

std::uint32_t DistanceField::nearest(std::int64_t i, std::int64_t j, std::int64_t k) const {
  expect_sample(i, j, k);
  const auto indices = tile_nearest(i / kTileSide, j / kTileSide, k / kTileSide);
  return indices ? (*indices)[within(i, j, k)] : kNoTriangle;
}

float DistanceField::background(std::int64_t tx, std::int64_t ty, std::int64_t tz) const {
  return background_of(slot_of(tx, ty, tz));
}

auto DistanceField::tile(std::int64_t tx, std::int64_t ty, std::int64_t tz) const -> std::optional<TileValues> {
  const std::int32_t slot = slot_of(tx, ty, tz);
  if (slot < 0) return std::nullopt;
  return TileValues(pool_->values(slot), kTileSamples);
}

auto DistanceField::tile_nearest(std::int64_t tx, std::int64_t ty, std::int64_t tz) const
    -> std::optional<TileNearest> {
  const std::int32_t slot = slot_of(tx, ty, tz);
  if (!pool_) return std::nullopt;
  if (!with_nearest_) fail_without_nearest();
  if (slot < 0) return std::nullopt;
  return TileNearest(pool_->nearest(slot), kTileSamples);
}

auto DistanceField::tile_at(std::int64_t index) const -> Tile {
  const Size3 n = tile_count();
  const std::int32_t slot = slots_[static_cast<std::size_t>(index)];
  return {index,
          {index % n.x, index / n.x % n.y, index / (n.x * n.y)},
          TileValues(pool_->values(slot), kTileSamples),
          with_nearest_ ? std::span<const std::uint32_t>(pool_->nearest(slot), kTileSamples)
                        : std::span<const std::uint32_t>()};
}

std::int32_t& DistanceField::entry_of(std::int64_t tx, std::int64_t ty, std::int64_t tz) {
  if (!pool_) fail_field([] { return "it is empty and has no room for tiles; make one with a grid"; });
  return slots_[static_cast<std::size_t>(tile_index(tx, ty, tz))];
}

std::span<float, kTileSamples> DistanceField::store_tile(std::int64_t tx, std::int64_t ty, std::int64_t tz) try {
  std::int32_t& entry = entry_of(tx, ty, tz);
  if (entry >= 0)
    fail_field([=] { return "the tile " + index_text(tx, ty, tz) + " is stored already; store each tile once"; });
  const std::int64_t slot = pool_->add();
  entry = static_cast<std::int32_t>(slot);
  return std::span<float, kTileSamples>(pool_->values(slot), kTileSamples);
} catch (...) {
  throw_field_error();
}

std::span<std::uint32_t, kTileSamples> DistanceField::store_nearest(std::int64_t tx, std::int64_t ty, std::int64_t tz) {
  const std::int32_t slot = entry_of(tx, ty, tz);
  if (slot < 0 || !with_nearest_)
    fail_field([=] {
      return "the tile " + index_text(tx, ty, tz) +
             " has no nearest triangles; store it first, in a field made with them";
    });
  return std::span<std::uint32_t, kTileSamples>(pool_->nearest(slot), kTileSamples);
}

std::span<float, kTileSamples> DistanceField::edit_tile(std::int64_t tx, std::int64_t ty, std::int64_t tz) {
  const std::int32_t slot = entry_of(tx, ty, tz);
  if (slot < 0) fail_field([=] { return "the tile " + index_text(tx, ty, tz) + " is not stored; store it first"; });
  return std::span<float, kTileSamples>(pool_->values(slot), kTileSamples);
}

void DistanceField::mark_inside(std::int64_t tx, std::int64_t ty, std::int64_t tz) {
  std::int32_t& entry = entry_of(tx, ty, tz);
  if (entry >= 0)
    fail_field([=] { return "the tile " + index_text(tx, ty, tz) + " is stored; write -thickness into its samples"; });
  entry = kInside;
}

void DistanceField::mark_outside(std::int64_t tx, std::int64_t ty, std::int64_t tz) {
  std::int32_t& entry = entry_of(tx, ty, tz);
  if (entry >= 0) fail_field([=] { return "the tile " + index_text(tx, ty, tz) + " is stored; erase it"; });
  entry = kOutside;
}

void DistanceField::erase_tile(std::int64_t tx, std::int64_t ty, std::int64_t tz) {
  const Size3 tile{tx, ty, tz};
  erase_tiles(std::span(&tile, 1));
}

void DistanceField::erase_tiles(std::span<const Size3> tiles) try {
  if (tiles.empty()) return;
  std::vector<std::size_t> entry_of_slot(static_cast<std::size_t>(stored_tiles()));
  for (std::size_t n = 0; n < slots_.size(); ++n)
    if (slots_[n] >= 0) entry_of_slot[static_cast<std::size_t>(slots_[n])] = n;
  // Remove all tiles from the table, or none.
  std::vector<std::int32_t> free;
  free.reserve(tiles.size());
  const auto index = [&](const Size3& at) { return static_cast<std::size_t>(tile_index(at.x, at.y, at.z)); };
  const auto take_out = [&](const Size3& at) {
    std::int32_t& entry = entry_of(at.x, at.y, at.z);
    if (entry < 0)
      fail_field([&] { return "the tile " + index_text(at.x, at.y, at.z) + " is not stored; erase a stored one"; });
    free.push_back(std::exchange(entry, kOutside));
  };
  try {
    for (const Size3& at : tiles) take_out(at);
  } catch (...) {
    for (std::size_t n = 0; n < free.size(); ++n) slots_[index(tiles[n])] = free[n];
    throw;
  }
  // Move the last tile into each free slot. Begin with the last free slot, so that the tile that moves is never free.
  std::ranges::sort(free, std::greater<>());
  for (const std::int32_t slot : free) {
    const auto last = static_cast<std::int32_t>(pool_->size() - 1);
    if (slot != last) {
      std::copy_n(pool_->values(last), kTileSamples, pool_->values(slot));
      if (with_nearest_) std::copy_n(pool_->nearest(last), kTileSamples, pool_->nearest(slot));
      const std::size_t moved = entry_of_slot[static_cast<std::size_t>(last)];
      slots_[moved] = slot;
      entry_of_slot[static_cast<std::size_t>(slot)] = moved;
    }
    pool_->remove_last();
  }
} catch (...) {
  throw_field_error();
}

void DistanceField::erase_nearest() {
  with_nearest_ = false;
  if (pool_) pool_->release_nearest();
}

bool DistanceField::has_sign() const {
  return !provenance_.sign.empty() || std::ranges::find(slots_, kInside) != slots_.end() ||
         std::ranges::any_of(tile_values(), [](float value) { return value < 0; });
}

std::span<const float> DistanceField::tile_values() const {
  if (!pool_) return {};
  return {pool_->values(0), static_cast<std::size_t>(pool_->size() * kTileSamples)};
}

std::span<const std::uint32_t> DistanceField::tile_nearest_values() const {
  if (!pool_) return {};
  if (!with_nearest_) fail_without_nearest();
  return {pool_->nearest(0), static_cast<std::size_t>(pool_->size() * kTileSamples)};
}

std::vector<std::array<std::int32_t, 3>> DistanceField::tile_coordinates() const try {
  std::vector<std::array<std::int32_t, 3>> coordinates(static_cast<std::size_t>(stored_tiles()));
  for (const Tile& tile : tiles())
    coordinates[static_cast<std::size_t>(slots_[static_cast<std::size_t>(tile.index)])] = {
        static_cast<std::int32_t>(tile.at.x), static_cast<std::int32_t>(tile.at.y),
        static_cast<std::int32_t>(tile.at.z)};
  return coordinates;
} catch (...) {
  throw_field_error();
}

std::int64_t DistanceField::memory_bytes() const {
  const auto tile_bytes = static_cast<std::int64_t>(sizeof(float) * kTileSamples * (with_nearest_ ? 2 : 1));
  const auto table_bytes = static_cast<std::int64_t>(slots_.size() * sizeof(std::int32_t));
  return stored_tiles() * tile_bytes + table_bytes;
}

namespace {

void expect_slices(const Grid& grid, std::int64_t first, std::int64_t count, std::size_t room) {
  const Size3& n = grid.size;
  if (first < 0 || first > n.z || count < 0 || count > n.z - first ||
      static_cast<std::int64_t>(room) != n.x * n.y * count)
    fail_field(
        [] { return "slices to copy are out of range or do not fit the memory given; give it a value a sample"; });
}

// Copies slices into dense memory from the stored tiles `all`, one per slot. Samples of other tiles are `outside` or
// `inside`.
template <class T>
void copy_tiled(const DistanceField& field, std::int64_t first, std::int64_t count, const T* all, T outside, T inside,
                T* out) {
  const Size3 n = field.grid().size, tiles = field.tile_count();
  const std::span<const std::int32_t> slots = field.slots();
  if (slots.empty()) {
    std::fill_n(out, n.x * n.y * count, outside);
    return;
  }
  for (std::int64_t k = first; k < first + count; ++k)
    for (std::int64_t j = 0; j < n.y; ++j) {
      const std::int32_t* slot = slots.data() + tiles.x * (j / kTileSide + tiles.y * (k / kTileSide));
      const std::int64_t row = kTileSide * (j % kTileSide + kTileSide * (k % kTileSide));
      for (std::int64_t i = 0; i < n.x; i += kTileSide, ++slot) {
        const std::int64_t run = std::min<std::int64_t>(kTileSide, n.x - i);
        if (*slot >= 0)
          std::copy_n(all + *slot * std::int64_t{kTileSamples} + row, run, out);
        else
          std::fill_n(out, run, *slot == DistanceField::kInside ? inside : outside);
        out += run;
      }
    }
}

// A tile's samples from dense memory.
struct DenseTile {
  std::array<float, kTileSamples> values;
  std::array<std::uint32_t, kTileSamples> nearest;
  bool outside, inside;  // whether every sample is at least the thickness away and has no nearest triangle

  DenseTile(const Grid& grid, float far, const Size3& at, std::span<const float> all_values,
            std::span<const std::uint32_t> all_nearest) {
    values.fill(far);
    nearest.fill(kNoTriangle);
    outside = inside = true;
    const std::int64_t i0 = at.x * kTileSide, j0 = at.y * kTileSide, k0 = at.z * kTileSide;
    for (std::int64_t k = k0; k < std::min(k0 + kTileSide, grid.size.z); ++k)
      for (std::int64_t j = j0; j < std::min(j0 + kTileSide, grid.size.y); ++j)
        for (std::int64_t i = i0; i < std::min(i0 + kTileSide, grid.size.x); ++i) {
          const auto from = static_cast<std::size_t>(grid.index(i, j, k));
          const auto to = static_cast<std::size_t>(i - i0 + kTileSide * (j - j0 + kTileSide * (k - k0)));
          values[to] = all_values[from];
          if (!all_nearest.empty()) nearest[to] = all_nearest[from];
          outside &= values[to] >= far && nearest[to] == kNoTriangle;
          inside &= values[to] <= -far && nearest[to] == kNoTriangle;
        }
  }
};

}  // namespace

void DistanceField::copy_slices(std::int64_t first, std::int64_t count, std::span<float> out) const {
  expect_slices(grid_, first, count, out.size());
  const auto far = static_cast<float>(thickness_);
  copy_tiled(*this, first, count, tile_values().data(), far, -far, out.data());
}

void DistanceField::copy_nearest_slices(std::int64_t first, std::int64_t count, std::span<std::uint32_t> out) const {
  if (!with_nearest_) fail_without_nearest();
  expect_slices(grid_, first, count, out.size());
  copy_tiled(*this, first, count, tile_nearest_values().data(), kNoTriangle, kNoTriangle, out.data());
}

std::vector<float> DistanceField::to_dense() const try {
  std::vector<float> values(static_cast<std::size_t>(grid_.sample_count()));
  copy_slices(0, grid_.size.z, values);
  return values;
} catch (...) {
  throw_as_error("field", "copy some slices at a time");
}

DistanceField DistanceField::from_dense(const Grid& grid, double thickness, std::span<const float> values,
                                        std::span<const std::uint32_t> nearest) try {
  DistanceField field(grid, thickness, !nearest.empty());
  const auto samples = static_cast<std::size_t>(grid.sample_count());
  if (values.size() != samples || (!nearest.empty() && nearest.size() != samples))
    throw Error(ErrorCode::usage, "field: " + std::to_string(values.size()) + " values given for " +
                                      std::to_string(samples) + " samples; give one for each");
  const Size3 tiles = field.tile_count();
  for (std::int64_t tz = 0; tz < tiles.z; ++tz)
    for (std::int64_t ty = 0; ty < tiles.y; ++ty)
      for (std::int64_t tx = 0; tx < tiles.x; ++tx) {
        const DenseTile tile(grid, static_cast<float>(thickness), {tx, ty, tz}, values, nearest);
        if (tile.outside) continue;
        if (tile.inside) {
          field.mark_inside(tx, ty, tz);
          continue;
        }
        std::ranges::copy(tile.values, field.store_tile(tx, ty, tz).begin());
        if (!nearest.empty()) std::ranges::copy(tile.nearest, field.store_nearest(tx, ty, tz).begin());
      }
  return field;
} catch (...) {
  throw_field_error();
}

namespace {

void add_value(float value, FieldSummary& found) {
  if (std::isnan(value)) return void(++found.nan);
  found.min = std::min(found.min, double{value});
  found.max = std::max(found.max, double{value});
}

// Adds the samples of a stored tile that lie in the grid.
void add_tile(const DistanceField& field, const DistanceField::Tile& tile, FieldSummary& found) {
  constexpr std::int64_t kSide = kTileSide;
  const Size3& size = field.grid().size;
  const auto far = static_cast<float>(field.thickness());
  for (std::int64_t k = 0; k < std::min(kSide, size.z - kSide * tile.at.z); ++k)
    for (std::int64_t j = 0; j < std::min(kSide, size.y - kSide * tile.at.y); ++j)
      for (std::int64_t i = 0; i < std::min(kSide, size.x - kSide * tile.at.x); ++i) {
        const auto n = static_cast<std::size_t>(i + kSide * (j + kSide * k));
        add_value(tile.values[n], found);
        found.band += tile.nearest.empty() ? std::abs(tile.values[n]) < far : tile.nearest[n] != kNoTriangle;
      }
}

}  // namespace

FieldSummary inspect(const DistanceField& field) try {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  FieldSummary found{infinity, -infinity};
  for (const DistanceField::Tile& tile : field.tiles()) add_tile(field, tile, found);
  // Count tiles that are not stored as a whole: a small file may have very many of them.
  const auto far = static_cast<float>(field.thickness());
  const std::span<const std::int32_t> slots = field.slots();
  if (slots.empty() || std::ranges::find(slots, DistanceField::kOutside) != slots.end()) add_value(far, found);
  if (std::ranges::find(slots, DistanceField::kInside) != slots.end()) add_value(-far, found);
  return found;
} catch (...) {
  throw_as_error("field");
}

}  // namespace standoff
