// SPDX-License-Identifier: Apache-2.0
#include "core/field_bytes.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

#include "core/tile_pool.h"
#include "standoff/field.h"

namespace standoff {

double field_bytes(double stored_tiles, double all_tiles, bool with_nearest) {
  constexpr double kTileBytes = sizeof(float) * DistanceField::kTileSamples;
  // Tiles are fewer than 2^31; what is more fits no memory, and steps do not matter.
  const double tiles = stored_tiles < 0x1p31
                           ? static_cast<double>(TilePool::in_steps(static_cast<std::int64_t>(stored_tiles)))
                           : stored_tiles;
  return tiles * kTileBytes * (with_nearest ? 2 : 1) + all_tiles * sizeof(std::int32_t);
}

std::string over_the_limit(double needed, double limit) {
  double unit = 1;
  const char* name = "B";
  for (const char* larger : {"KiB", "MiB"}) {
    const double in_larger = limit / (1024 * unit);
    if (in_larger < 10 && (in_larger < 1 || in_larger != std::floor(in_larger))) break;
    unit *= 1024;
    name = larger;
  }
  // Rounded away from each other, so that they differ.
  char text[96];
  std::snprintf(text, sizeof text, "%.0f %s, more than the limit of %.0f %s", std::ceil(needed / unit), name,
                std::floor(limit / unit), name);
  return text;
}

ErrorDetails limit_details(double needed, double limit) {
  const auto whole = [](double bytes) { return static_cast<std::int64_t>(std::min(bytes, 0x1p62)); };
  return {.bytes_needed = whole(std::ceil(needed)), .bytes_limit = whole(limit)};
}

}  // namespace standoff
