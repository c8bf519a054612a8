// SPDX-License-Identifier: Apache-2.0
#include "sign/open_winding/open_winding.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

#include "core/grid_axis.h"
#include "core/progress.h"
#include "core/tile_count.h"
#include "sign/open_winding/tile_signs.h"

namespace standoff {

// Tiles where the winding number is smooth.

namespace {

struct TileRange {
  std::int64_t begin, end;
};

// The tiles that may have samples between low and high, widened by more than rounding. Tile t has samples 8t to 8t + 7.
TileRange tiles_between(double low, double high, const GridAxis& axis) {
  const double begin = axis.at(0), spacing = axis.spacing;
  const double margin =
      0.01 + 1e-15 * (std::abs(low) + std::abs(high) + std::abs(begin) + std::abs(axis.origin)) / spacing;
  const double tiles = static_cast<double>(tiles_along(axis.size));
  const double first = std::ceil(((low - begin) / spacing - margin - (kTileSide - 1)) / kTileSide),
               last = std::floor(((high - begin) / spacing + margin) / kTileSide);
  return {static_cast<std::int64_t>(std::clamp(first, 0.0, tiles)),
          static_cast<std::int64_t>(std::clamp(last + 1, 0.0, tiles))};
}

// Calls use(tx, ty, tz) for each tile that the triangle's box may touch.
template <class Use>
void for_each_tile(const std::array<Vec3, 3>& t, const Grid& grid, const Use& use) {
  const Vec3 low = min(t[0], min(t[1], t[2])), high = max(t[0], max(t[1], t[2]));
  const TileRange x = tiles_between(low.x, high.x, axis_of(grid, 0)),
                  y = tiles_between(low.y, high.y, axis_of(grid, 1)),
                  z = tiles_between(low.z, high.z, axis_of(grid, 2));
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

// Whether a cap is larger than a tile along some axis.
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

// All rows of tiles.

namespace {

// Decides the tiles of one row of tiles, many at once where the mesh or its caps are far.
class RowOfTiles {
 public:
  RowOfTiles(const OpenMesh& mesh, const OpenTiles& open_tiles, const RowWindings& windings, std::int64_t ty,
             std::int64_t tz, InsideRows& rows, ProgressMeter& progress)
      : mesh_(mesh),
        open_tiles_(open_tiles),
        windings_(windings),
        ty_(ty),
        tz_(tz),
        rows_(rows),
        check_(progress, kLooks),
        stack_(mesh.tree, check_),
        tile_signs_(mesh, stack_) {}

  // Returns the number of doubtful samples.
  std::int64_t decide() {
    decide({rows_.tiles_begin(), rows_.tiles_end()}, stack_.root(), {});
    return doubtful_;
  }

 private:
  struct Tiles {
    std::int64_t begin, end;
  };

  void decide(const Tiles& tiles, NodeStack::Part nodes, LinearField far) {
    const std::size_t size = stack_.size();
    const SampleBox box = samples_of(tiles);
    const Cell cell = cell_of(mesh_.grid, box);
    far.move_to(cell.center);
    // Let nodes that are smaller than the cell wait for smaller cells.
    const NodeStack::Part near = stack_.add_far(nodes, cell, kFieldTolerance, cell.radius, far);
    const double reach = far.reach(cell.half) + stack_.bound_of(near, cell, 0.5);
    if (!decide_by_windings(box, far.value, reach)) {
      if (tiles.end - tiles.begin > 1) {
        const std::int64_t middle = (tiles.begin + tiles.end) / 2;
        decide({tiles.begin, middle}, near, far);
        decide({middle, tiles.end}, near, far);
      } else {
        doubtful_ += tile_signs_.decide(box, windings_, open_tiles_.contains(tiles.begin, ty_, tz_), near, far,
                                        rows_.tile(tiles.begin));
      }
    }
    stack_.resize(size);
  }

  SampleBox samples_of(const Tiles& tiles) const {
    const Size3& size = mesh_.grid.size;
    return {{kTileSide * tiles.begin, kTileSide * ty_, kTileSide * tz_},
            {std::min(kTileSide * tiles.end, size.x), std::min(kTileSide * ty_ + kTileSide, size.y),
             std::min(kTileSide * tz_ + kTileSide, size.z)}};
  }

  // Decides by the winding numbers of the rows where no cap is near, and the caps' sum brings none of them near a
  // threshold. Returns whether it did.
  bool decide_by_windings(const SampleBox& box, double angles, double reach) {
    if (!(reach < 0.5 - kDoubt)) return false;
    for (int row = 0; row < InsideRows::kRows; ++row) {
      if (!rows_.in_grid(row)) continue;
      bool sure = true;
      windings_.for_each(row, box.begin[0], box.end[0], [&](std::int64_t, std::int64_t, std::int32_t winding) {
        sure = sure && margin(winding + angles, mesh_.rule) > reach + kDoubt;
      });
      if (!sure) return false;
    }
    for (int row = 0; row < InsideRows::kRows; ++row) {
      if (!rows_.in_grid(row)) continue;
      windings_.for_each(row, box.begin[0], box.end[0], [&](std::int64_t from, std::int64_t to, std::int32_t winding) {
        if (is_inside(winding + angles, mesh_.rule)) rows_.set(row, from, to);
      });
    }
    return true;
  }

  const OpenMesh& mesh_;
  const OpenTiles& open_tiles_;
  const RowWindings& windings_;
  std::int64_t ty_, tz_;
  InsideRows& rows_;
  WorkCheck check_;
  NodeStack stack_;
  TileSigns tile_signs_;
  std::int64_t doubtful_ = 0;
};

constexpr std::int64_t kCapCrossingBytes = 1 << 18;  // a choice

}  // namespace

OpenWinding::OpenWinding(const OrientedMesh& mesh, std::shared_ptr<const Caps> caps, const Grid& grid, WindingRule rule,
                         ProgressMeter& progress, std::int64_t bytes)
    : grid_(grid),
      rule_(rule),
      progress_(progress),
      caps_(std::move(caps)),
      open_tiles_(mesh, caps_->rims, grid, progress),
      mesh_crossings_(mesh, grid, progress, bytes),
      cap_crossings_({caps_->mesh}, grid, progress, bytes == kAllCrossings ? bytes : kCapCrossingBytes) {
  if (bytes == kAllCrossings) load(0);
}

// Polygons of many corners are cut up: an edge becomes at most 5/3 corners and triangles of rims (Rims), and a rim has
// three corners or more.
std::int64_t OpenWinding::bytes(std::int64_t boundary, const Size3& size, int threads) {
  const std::int64_t corners = 5 * boundary / 3, rims = boundary / 3 + 1;
  const std::int64_t polygons = corners * sizeof(Vec3) + rims * (sizeof(Vec3) + 12),
                     tree = 2 * rims * sizeof(RimTree::Node), while_built = rims * (sizeof(Moments) + 4),
                     quick = corners * (9 * sizeof(float) + 8) + 2 * rims * 16 + 9 * 64,
                     mesh = (corners + rims) * sizeof(Vec3) + corners * sizeof(Triangle);
  const std::int64_t crossings = std::max(kCapCrossingBytes, RowCrossings::least_bytes(corners, threads)) +
                                 RowCrossings::other_bytes(corners, Grid{size, {}, {1, 1, 1}}, threads);
  return polygons + tree + std::max(while_built, quick + mesh + tile_count(size) + crossings);
}

void OpenWinding::fill(InsideRows& rows, std::int64_t ty, std::int64_t tz) const {
  const OpenMesh mesh{grid_, rule_, caps_->rims, caps_->tree, caps_->quick};
  const RowWindings windings(mesh_crossings_.of_tiles(ty, tz), cap_crossings_.of_tiles(ty, tz));
  const std::int64_t doubtful = RowOfTiles(mesh, open_tiles_, windings, ty, tz, rows, progress_).decide();
  doubtful_.fetch_add(doubtful, std::memory_order_relaxed);
}

double OpenWinding::winding_number(std::int64_t i, std::int64_t j, std::int64_t k) const {
  ProgressMeter nobody;
  WorkCheck unwatched(nobody, kLooks);
  return winding_number(i, j, k, 0, unwatched);
}

double OpenWinding::winding_number(std::int64_t i, std::int64_t j, std::int64_t k, double error,
                                   WorkCheck& check) const {
  const std::int64_t ty = j / kTileSide, tz = k / kTileSide;
  const RowWindings windings(mesh_crossings_.of_tiles(ty, tz), cap_crossings_.of_tiles(ty, tz));
  double winding = 0;
  windings.for_each(static_cast<int>(j % kTileSide + kTileSide * (k % kTileSide)), i, i + 1,
                    [&](std::int64_t, std::int64_t, std::int32_t n) { winding = n; });
  NodeStack stack(caps_->tree, check);
  const Vec3 p = grid_.position(i, j, k);
  for (double tolerance = kFieldTolerance / 16;; tolerance = tolerance > error / 1024 ? tolerance / 16 : 0) {
    const Interval sum = cap_sum_at(caps_->rims, caps_->tree, p, error > 0 ? tolerance : 0, stack);
    if (error == 0 || tolerance == 0 || sum.error <= error) return winding + sum.value;
  }
}

}  // namespace standoff
