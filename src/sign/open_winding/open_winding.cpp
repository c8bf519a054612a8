// SPDX-License-Identifier: Apache-2.0
#include "sign/open_winding/open_winding.h"

#include <algorithm>

#include "core/tile_count.h"
#include "sign/open_winding/tile_sides.h"
#include "sign/open_winding/winding_rule.h"

namespace standoff {
namespace {

// Decides the tiles of one row of tiles: as many as possible at once, where the mesh is far, or its caps are.
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
        tile_sides_(mesh, stack_) {}

  /// Returns how many samples are doubtful.
  std::int64_t decide() {
    decide({0, tiles_along(mesh_.grid.size.x)}, stack_.root(), {});
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
    // Nodes much smaller than the cell wait for smaller cells.
    const NodeStack::Part near = stack_.add_far(nodes, cell, kFieldTolerance, cell.radius / 1, far);
    const double reach = far.reach(cell.half) + stack_.bound_of(near, cell, 0.5);
    if (!decide_by_windings(box, far.value, reach)) {
      if (tiles.end - tiles.begin > 1) {
        const std::int64_t middle = (tiles.begin + tiles.end) / 2;
        decide({tiles.begin, middle}, near, far);
        decide({middle, tiles.end}, near, far);
      } else {
        doubtful_ += tile_sides_.decide(box, windings_, open_tiles_.contains(tiles.begin, ty_, tz_), near, far,
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

  // Where no cap is near, the winding numbers of the rows decide, if what the caps add keeps all of them off the
  // thresholds. Returns whether it does.
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
  TileSides tile_sides_;
  std::int64_t doubtful_ = 0;
};

}  // namespace

OpenWinding::OpenWinding(const OrientedMesh& mesh, const Boundary& boundary, const Grid& grid, WindingRule rule,
                         ProgressMeter& progress)
    : grid_(grid),
      rule_(rule),
      progress_(progress),
      rims_(boundary, progress),
      tree_(rims_, progress),
      quick_(rims_, tree_, progress),
      open_tiles_(mesh, rims_, grid, progress),
      mesh_crossings_(mesh, grid, progress),
      cap_crossings_({caps_of(rims_)}, grid, progress) {}

void OpenWinding::fill(InsideRows& rows, std::int64_t ty, std::int64_t tz) const {
  const OpenMesh mesh{grid_, rule_, rims_, tree_, quick_};
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
  NodeStack stack(tree_, check);
  const Vec3 p = grid_.position(i, j, k);
  for (double tolerance = kFieldTolerance / 16;; tolerance = tolerance > error / 1024 ? tolerance / 16 : 0) {
    const Interval sum = cap_sum_at(rims_, tree_, p, error > 0 ? tolerance : 0, stack);
    if (error == 0 || tolerance == 0 || sum.error <= error) return winding + sum.value;
  }
}

}  // namespace standoff
