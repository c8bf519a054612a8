// How much room the lists of a field may want: guesses, and which way a thickness goes.
#pragma once

#include <algorithm>
#include <cstdint>

#include "difi/compute.h"

namespace difi::gpu {

/// Tiles copied between device and host at once: 32 MiB.
inline constexpr std::int64_t kTilesAtOnce = 16384;

/// Up to this many spacings triangles are binned straight into tiles, beyond they are handed down from coarse cells:
/// as on the CPU, whose constant this repeats.
inline constexpr double kThinBand = 4;
inline bool is_thin(const Grid& grid, double thickness) { return thickness <= kThinBand * grid.max_spacing(); }

inline std::int64_t tile_count(const Grid& grid) {
  return (grid.size.x + 7) / 8 * ((grid.size.y + 7) / 8) * ((grid.size.z + 7) / 8);
}

/// Bytes of host memory that a run takes beside its output.
inline std::int64_t host_scratch_bytes(const Grid& grid) {
  return 4 * tile_count(grid) + 2 * 4 * kTilesAtOnce * DistanceField::kTileSamples;
}

/// Small triangles lie in four or five tiles at thickness 2; a tile far from a surface keeps some tens.
inline std::int64_t likely_entries(std::int64_t triangles, const Grid& grid, double thickness, Method method) {
  if (method == Method::thesis) return 0;
  if (is_thin(grid, thickness)) return 6 * triangles + 2 * tile_count(grid);
  return std::max<std::int64_t>(4 * triangles, 64) + 48 * tile_count(grid);
}

}  // namespace difi::gpu
