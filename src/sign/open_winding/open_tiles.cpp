// SPDX-License-Identifier: Apache-2.0
#include "sign/open_winding/open_tiles.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

#include "core/progress.h"
#include "core/tile_count.h"
#include "sign/open_winding/cell_touch.h"
#include "sign/open_winding/cells.h"

namespace standoff {
namespace {

struct TileRange {
  std::int64_t begin, end;
};

// The tiles whose samples low to high may be among, widened by more than rounding. Tile t is samples 8t to 8t + 7.
TileRange tiles_between(double low, double high, double origin, double spacing, std::int64_t samples) {
  const double margin = 0.01 + 1e-15 * (std::abs(low) + std::abs(high) + std::abs(origin)) / spacing;
  const double tiles = static_cast<double>(tiles_along(samples));
  const double first = std::ceil(((low - origin) / spacing - margin - (kTileSide - 1)) / kTileSide),
               last = std::floor(((high - origin) / spacing + margin) / kTileSide);
  return {static_cast<std::int64_t>(std::clamp(first, 0.0, tiles)),
          static_cast<std::int64_t>(std::clamp(last + 1, 0.0, tiles))};
}

// Calls use(tx, ty, tz) for each tile that the triangle's box may touch.
template <class Use>
void for_each_tile(const std::array<Vec3, 3>& t, const Grid& grid, const Use& use) {
  const Vec3 low = min(t[0], min(t[1], t[2])), high = max(t[0], max(t[1], t[2]));
  const TileRange x = tiles_between(low.x, high.x, grid.origin.x, grid.spacing.x, grid.size.x),
                  y = tiles_between(low.y, high.y, grid.origin.y, grid.spacing.y, grid.size.y),
                  z = tiles_between(low.z, high.z, grid.origin.z, grid.spacing.z, grid.size.z);
  for (std::int64_t tz = z.begin; tz < z.end; ++tz)
    for (std::int64_t ty = y.begin; ty < y.end; ++ty)
      for (std::int64_t tx = x.begin; tx < x.end; ++tx) use(tx, ty, tz);
}

Cell cell_of_tile(const Grid& grid, std::int64_t tx, std::int64_t ty, std::int64_t tz) {
  return cell_of(grid,
                 {{kTileSide * tx, kTileSide * ty, kTileSide * tz},
                  {std::min(kTileSide * tx + kTileSide, grid.size.x), std::min(kTileSide * ty + kTileSide, grid.size.y),
                   std::min(kTileSide * tz + kTileSide, grid.size.z)}});
}

// A cap that is larger than a tile on some axis.
bool is_large(const Rim& rim, const Grid& grid) {
  Box box;
  for (const Vec3& corner : rim.corners) box.include(corner);
  const Vec3 samples = box.extent() / grid.spacing;
  return std::max({samples.x, samples.y, samples.z}) > kTileSide;
}

}  // namespace

OpenTiles::OpenTiles(const OrientedMesh& mesh, const Rims& rims, const Grid& grid, ProgressMeter& progress)
    : tiles_x_(tiles_along(grid.size.x)), tiles_y_(tiles_along(grid.size.y)) {
  const auto mark_of = [&](std::int64_t tx, std::int64_t ty, std::int64_t tz) -> std::uint8_t& {
    return marks_[static_cast<std::size_t>(tx + tiles_x_ * (ty + tiles_y_ * tz))];
  };
  constexpr std::int64_t kCheckEvery = 1 << 16;  // triangles and tiles
  WorkCheck of_caps(progress, kCheckEvery);
  for (std::size_t n = 0; n < rims.size(); ++n) {
    of_caps.add(1);
    const Rim rim = rims[n];
    if (!is_large(rim, grid)) continue;
    if (marks_.empty()) marks_.resize(static_cast<std::size_t>(tile_count(grid.size)));
    const Vec3* corner = &rim.corners.back();
    for (const Vec3& next : rim.corners) {
      const std::array<Vec3, 3> t = {rim.apex, *corner, next};
      for_each_tile(t, grid, [&](std::int64_t tx, std::int64_t ty, std::int64_t tz) {
        of_caps.add(1);
        std::uint8_t& mark = mark_of(tx, ty, tz);
        if (mark == 0 && may_touch(t, cell_of_tile(grid, tx, ty, tz))) mark = kCap;
      });
      corner = &next;
    }
  }
  if (marks_.empty()) return;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, mesh.mesh.triangles.size(), 4096), [&](const auto& range) {
    WorkCheck check(progress, kCheckEvery);
    for (std::size_t n = range.begin(); n != range.end(); ++n) {
      check.add(1);
      if (mesh.use_of(n) == 0) continue;
      const std::array<Vec3, 3> t = mesh.corners(n);
      for_each_tile(t, grid, [&](std::int64_t tx, std::int64_t ty, std::int64_t tz) {
        check.add(1);
        const std::atomic_ref<std::uint8_t> mark(mark_of(tx, ty, tz));
        if (mark.load(std::memory_order_relaxed) == kCap && may_touch(t, cell_of_tile(grid, tx, ty, tz)))
          mark.store(kCap | kMesh, std::memory_order_relaxed);
      });
    }
  });
}

}  // namespace standoff
