// SPDX-License-Identifier: Apache-2.0
// From tiles to dense memory and back.
#include <algorithm>
#include <array>

#include "core/field_error.h"
#include "core/tile_count.h"
#include "standoff/field.h"

namespace standoff {
namespace {

void expect_slices(const Grid& grid, std::int64_t first, std::int64_t count, std::size_t room) {
  const Size3& n = grid.size;
  if (first < 0 || first > n.z || count < 0 || count > n.z - first ||
      static_cast<std::int64_t>(room) != n.x * n.y * count)
    fail_field(
        [] { return "slices to copy are out of range or do not fit the memory given; give it a value a sample"; });
}

// Copies slices into dense memory from the stored tiles `all`, a slot each. What is not stored is `outside` or
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

// One tile's samples, taken from dense memory.
struct DenseTile {
  std::array<float, kTileSamples> values;
  std::array<std::uint32_t, kTileSamples> nearest;
  bool outside, inside;  // whether every sample is at least so far away and has no nearest triangle

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

}  // namespace standoff
