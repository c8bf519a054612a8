// SPDX-License-Identifier: Apache-2.0
#include "standoff/inspect.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "core/guarded.h"
#include "core/tile_count.h"

namespace standoff {
namespace {

void add_value(float value, FieldSummary& found) {
  if (std::isnan(value)) return void(++found.nan);
  found.min = std::min(found.min, double{value});
  found.max = std::max(found.max, double{value});
}

// The samples of a stored tile that lie in the grid.
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
  // A tile that is not stored has one value. A file of few bytes may ask for very many of these.
  const auto far = static_cast<float>(field.thickness());
  const std::span<const std::int32_t> slots = field.slots();
  if (slots.empty() || std::ranges::find(slots, DistanceField::kOutside) != slots.end()) add_value(far, found);
  if (std::ranges::find(slots, DistanceField::kInside) != slots.end()) add_value(-far, found);
  return found;
} catch (...) {
  throw_as_error("field");
}

}  // namespace standoff
