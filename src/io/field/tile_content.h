// SPDX-License-Identifier: Apache-2.0
// What a tile that was read from a file holds, and the error of a value that no field has.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>

#include "core/number_text.h"
#include "core/tile_count.h"
#include "files/file_view.h"
#include "standoff/field.h"

namespace standoff {

/// What the values of a tile are: clamped outside, clamped inside, others, or such as no field has.
enum class TileContent { outside, inside, near, bad };

/// Says what a tile holds of which `samples` lie in the grid; the others are `far`. It has no branches, so that it
/// costs little beside reading: NaN is neither within the thickness nor as far as it.
inline TileContent content(const std::array<float, kTileSamples>& tile, float far, std::int64_t samples) {
  std::int64_t good = 0, outside = 0, inside = 0;
  for (const float value : tile) {
    good += static_cast<int>(std::abs(value) <= far);
    outside += static_cast<int>(value >= far);
    inside += static_cast<int>(value <= -far);
  }
  if (good != static_cast<int>(kTileSamples)) return TileContent::bad;
  if (outside == static_cast<int>(kTileSamples)) return TileContent::outside;
  return inside == samples ? TileContent::inside : TileContent::near;
}

/// Whether a sample has a nearest triangle. This has no branches either: most tiles of a band's file have no triangle.
inline bool has_triangle(const std::array<std::uint32_t, kTileSamples>& tile) {
  int found = 0;
  for (const std::uint32_t triangle : tile) found |= static_cast<int>(triangle != kNoTriangle);
  return found != 0;
}

/// Throws the error of the first bad value of the tile whose first sample is `first`.
[[noreturn]] inline void fail_at_bad(const FileView& file, const std::array<float, kTileSamples>& tile, float far,
                                     Size3 first) {
  const auto bad = std::ranges::find_if(tile, [far](float value) { return !(std::abs(value) <= far); });
  const std::int64_t at = bad - tile.begin();
  const auto name = [](std::int64_t i) { return std::to_string(i); };
  file.fail("sample (" + name(first.x + at % kTileSide) + "," + name(first.y + at / kTileSide % kTileSide) + "," +
                name(first.z + at / (kTileSide * kTileSide)) + ")",
            "the value " + exact_text(*bad) + " is not a number, or larger in magnitude than the thickness, " +
                exact_text(far) + "; the file is damaged or no distance field, write it again");
}

}  // namespace standoff
