// SPDX-License-Identifier: Apache-2.0
#include "sign/diagnosis/winding_range.h"

#include <algorithm>

#include "core/tile_count.h"
#include "sign/rows/row_crossings.h"

namespace standoff {
namespace {

// Rows that pass through the triangles' boxes, by the boxes' areas, if there are `rows` by `rows` of them.
double tests_of(MeshView mesh, const Box& bounds, std::int64_t rows) {
  double share = 0;
  const Vec3 whole = bounds.extent();
  if (!(whole.y > 0 && whole.z > 0)) return 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    Box box;
    for (const Vec3& corner : mesh.corners(t)) box.include(corner);
    share += box.extent().y / whole.y * (box.extent().z / whole.z);
  }
  return share * static_cast<double>(rows * rows);
}

// Samples in the middle of as many cells of the bounds.
Grid samples_in(const Box& bounds, std::int64_t rows) {
  Grid grid;
  grid.size = {1024, rows, rows};
  const Vec3 cells{1024, static_cast<double>(rows), static_cast<double>(rows)};
  Vec3 extent = bounds.extent();
  for (double* side : {&extent.x, &extent.y, &extent.z})
    if (!(*side > 0)) *side = 1;  // no sample can be inside
  grid.spacing = extent / cells;
  grid.origin = bounds.min + grid.spacing * 0.5;
  return grid;
}

}  // namespace

WindingRange find_winding_range(const OrientedMesh& mesh, const Box& bounds) {
  const ProgressCallback none;
  ProgressMeter progress(none);
  // Thousands of shells inside each other have very many crossings, and show most of their winding numbers in any row.
  constexpr double kMostTests = 2e7;
  constexpr std::int64_t kBytes = 1 << 20;  // of crossings at a time
  std::int64_t rows = 128;
  for (double tests = tests_of(mesh.mesh, bounds, rows); tests > kMostTests && rows > 8; tests /= 4) rows /= 2;
  const Grid grid = samples_in(bounds, rows);
  RowCrossings crossings(mesh, grid, progress, kBytes);
  WindingRange range;
  const std::int64_t tiles_y = tiles_along(grid.size.y), rows_of_tiles = tiles_y * tiles_along(grid.size.z);
  for (std::int64_t first = 0, end = 0; first < rows_of_tiles; first = end) {
    end = std::min(rows_of_tiles, crossings.load(first));
    for (std::int64_t tiles = first; tiles < end; ++tiles) {
      const std::span<const RowCrossing> row = crossings.of_tiles(tiles % tiles_y, tiles / tiles_y);
      std::int32_t winding = 0;
      for (std::size_t n = 0; n < row.size(); ++n) {
        if (n > 0 && row[n].row() != row[n - 1].row()) winding = 0;
        winding += row[n].step();
        const bool last = n + 1 == row.size() || row[n + 1].row() != row[n].row() || row[n + 1].past() != row[n].past();
        if (!last) continue;
        range.least = std::min(range.least, winding);
        range.most = std::max(range.most, winding);
      }
    }
  }
  return range;
}

}  // namespace standoff
