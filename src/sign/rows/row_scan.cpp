// SPDX-License-Identifier: Apache-2.0
#include "sign/rows/row_scan.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "core/tile_count.h"
#include "sign/signs.h"
#include "simd/dispatch.h"

namespace standoff {
namespace {

using cpu::CrossedRows;
using cpu::RowCorners;
using cpu::RowStrip;
using cpu::RowTriangles;

double largest(double a, double b, double c) { return std::max(std::max(a, b), c); }

// The corners of a triangle in its orientation, 1 or -1, as triangle n.
template <bool kPacked>
void load_corners(const MeshView& mesh, std::size_t triangle, int use, std::size_t n, RowCorners& to) {
  for (std::size_t c = 0; c < 3; ++c) {
    const std::size_t from = use > 0 ? c : (3 - c) % 3;
    Vec3 corner;
    if constexpr (kPacked) {
      const auto vertex = detail::load<std::uint32_t>(mesh.triangles.data() + sizeof(Triangle) * triangle + 4 * from);
      corner = detail::load_vertex<double>(mesh.vertices.data() + sizeof(Vec3) * vertex);
    } else {
      corner = mesh.corner(triangle, static_cast<int>(from));
    }
    to.at[0][c][n] = corner.x;
    to.at[1][c][n] = corner.y;
    to.at[2][c][n] = corner.z;
  }
}

// Rows p < width that a triangle may cross in the plane q: between the cuts of its sides.
struct ScanSpan {
  std::int32_t begin, end;
};
ScanSpan span_in_plane(const RowTriangles& triangles, int triangle, double q, double slack, std::int32_t width) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (int n = 0; n < 3; ++n) {
    const auto at = [&](int axis, int corner) -> double { return triangles.at[axis][corner % 3][triangle]; };
    const double q0 = at(2, n), q1 = at(2, n + 1), p0 = at(1, n), p1 = at(1, n + 1);
    if (q < std::min(q0, q1) - slack || q > std::max(q0, q1) + slack) continue;
    const double rise = q1 - q0, run = p1 - p0;
    double from = p0, to = p1;
    // Cut the side if the cut is off by less than half a row; else take all of the side.
    if (std::abs(run) * 4 * slack < std::abs(rise)) from = to = p0 + run * std::clamp((q - q0) / rise, 0.0, 1.0);
    low = std::min({low, from, to});
    high = std::max({high, from, to});
  }
  if (!(low <= high)) return {0, 0};
  const double begin = std::clamp(std::floor(low) - 1, 0.0, static_cast<double>(width)),
               end = std::clamp(std::ceil(high) + 2, begin, static_cast<double>(width));
  return {static_cast<std::int32_t>(begin), static_cast<std::int32_t>(end)};
}

}  // namespace

// Triangles, and strips of their rows that wait for the kernel.
struct RowScan::Batch {
  Batch(const RowWindow& rows, CrossingList& to, const Grid& grid, double slack)
      : window(rows),
        list(to),
        tile{rows.begin[0] - rows.begin[0] % kTileSide, rows.begin[1] - rows.begin[1] % kTileSide},
        tiles_y(tiles_along(grid.size.y)) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      space.origin[axis] = grid.origin[axis];
      space.spacing[axis] = grid.spacing[axis];
      space.per_spacing[axis] = 1 / grid.spacing[axis];
      space.first[axis] = static_cast<double>(grid.first[axis]);
      if (axis == 0) continue;
      space.begin[axis] = static_cast<double>(rows.begin[axis - 1]);
      space.end[axis] = static_cast<double>(rows.end[axis - 1]);
      space.tile[axis] = static_cast<double>(tile[axis - 1]);
    }
    space.size_x = static_cast<double>(grid.size.x);
    space.tiles_y = static_cast<float>(tiles_y);
    space.slack = slack;
  }

  const RowWindow& window;
  CrossingList& list;
  std::array<std::int64_t, 2> tile;  // the first row of the window's first tile
  std::int64_t tiles_y;              // tiles of the grid along y
  cpu::RowSpace space;
  int count = 0;
  std::array<std::size_t, RowCorners::kMost> numbers;  // of the triangles
  RowCorners corners;
  RowTriangles triangles{};
  int strip_count = 0;
  std::array<RowStrip, CrossedRows::kMostStrips> strips;
  CrossedRows found;

  // The row (j, k) of the grid that is row (p, q) of a triangle.
  std::array<std::int64_t, 2> row_of(std::int32_t triangle, std::int32_t p, std::int32_t q) const {
    return {tile[0] + static_cast<std::int64_t>(triangles.first[1][triangle]) + p,
            tile[1] + static_cast<std::int64_t>(triangles.first[2][triangle]) + q};
  }
  bool add_crossing(std::int64_t j, std::int64_t k, std::int64_t past, bool enters) const {
    const auto y = static_cast<std::uint64_t>(j - tile[0]), z = static_cast<std::uint64_t>(k - tile[1]);
    const std::uint64_t tiles = y / kTileSide + static_cast<std::uint64_t>(tiles_y) * (z / kTileSide),
                        row = InsideRows::kRows * tiles + y % kTileSide + kTileSide * (z % kTileSide);
    FoundCrossing* const to = list.add(1);
    if (to) *to = FoundCrossing::make(2 * row + std::uint64_t{enters}, static_cast<std::uint64_t>(past));
    return to != nullptr;
  }
};

RowScan::RowScan(const OrientedMesh& mesh, const Grid& grid, Simd simd)
    : mesh_(mesh),
      grid_(grid),
      x_(axis_of(grid, 0)),
      y_(axis_of(grid, 1)),
      z_(axis_of(grid, 2)),
      kernels_(&dispatch_of<cpu::SignKernels>().of(simd, "sign")) {
  // Three operations turn a corner into samples, and each adds an error of 2^-53 times at most size + kMost. Two
  // roundings move a sample off its place, by 2^-53 times at most size and size + |origin| / spacing.
  const auto slack = [](const GridAxis& axis) {
    return 0x1p-50 * (static_cast<double>(axis.first + axis.size) + RowTriangles::kMostCoordinate +
                      std::abs(axis.origin) / axis.spacing);
  };
  slack_ = largest(slack(axis_of(grid, 0)), slack(axis_of(grid, 1)), slack(axis_of(grid, 2)));
  const double per = largest(1 / grid.spacing.x, 1 / grid.spacing.y, 1 / grid.spacing.z);
  filters_ = slack_ < cpu::kNearRow / 2 && per < std::numeric_limits<double>::infinity() &&
             grid.size.x < RowTriangles::kMostSamples;
}

bool RowScan::scan(std::size_t first, std::size_t end, const RowWindow& window, CrossingList& list) const {
  Batch batch(window, list, grid_, slack_);
  if (!filters_) {
    for (std::size_t t = first; t < end; ++t)
      if (!add_all_exactly(t, batch)) return false;
    return true;
  }
  const bool is_packed = mesh_.mesh.triangles.packed() && mesh_.mesh.vertices.packed();
  return is_packed ? scan_filtered<true>(first, end, batch) : scan_filtered<false>(first, end, batch);
}

template <bool kPacked>
bool RowScan::scan_filtered(std::size_t first, std::size_t end, Batch& batch) const {
  for (std::size_t t = first; t < end;) {
    for (batch.count = 0; t < end && batch.count < RowCorners::kMost; ++t) {
      const int use = mesh_.use_of(t);
      if (use == 0) continue;
      const auto n = static_cast<std::size_t>(batch.count++);
      batch.numbers[n] = t;
      load_corners<kPacked>(mesh_.mesh, t, use, n, batch.corners);
    }
    if (!add_triangles(batch)) return false;
  }
  return true;
}

bool RowScan::add_triangles(Batch& batch) const {
  RowTriangles& triangles = batch.triangles;
  kernels_->find_rows(batch.corners, batch.count, batch.space, triangles);
  for (std::uint64_t any = triangles.any; any != 0; any &= any - 1) {
    const int n = std::countr_zero(any);
    if ((triangles.fits >> n & 1) != 0) {
      if (!add_strips(n, batch)) return false;
    } else {
      const auto [j, k] = batch.row_of(n, 0, 0);
      if (!add_rows_exactly(batch.numbers[static_cast<std::size_t>(n)],
                            {{j, k}, {j + triangles.rows[1][n], k + triangles.rows[2][n]}}, batch))
        return false;
    }
  }
  return finish(batch);
}

bool RowScan::add_strip(const RowStrip& strip, Batch& batch) const {
  if (batch.strip_count == CrossedRows::kMostStrips && !finish(batch)) return false;
  batch.strips[static_cast<std::size_t>(batch.strip_count++)] = strip;
  return true;
}

// Adds all rows of triangle n of the batch.
bool RowScan::add_strips(int n, Batch& batch) const {
  const RowTriangles& triangles = batch.triangles;
  const std::int32_t columns = triangles.rows[1][n], planes = triangles.rows[2][n];
  if (columns <= RowStrip::kMostWidth) {
    const std::int32_t at_once = RowStrip::kMostRows / columns;
    for (std::int32_t q = 0; q < planes; q += at_once)
      if (!add_strip({n, 0, q, columns, std::min(at_once, planes - q)}, batch)) return false;
    return true;
  }
  // What is rounded to float is off by this much.
  const double slack = slack_ + 0x1p-23 * std::max(double{triangles.most[1][n]}, double{triangles.most[2][n]});
  for (std::int32_t q = 0; q < planes; ++q) {
    const ScanSpan span = span_in_plane(triangles, n, q, slack, columns);
    for (std::int32_t p = span.begin; p < span.end; p += RowStrip::kMostRows)
      if (!add_strip({n, p, q, std::min(RowStrip::kMostRows, span.end - p), 1}, batch)) return false;
  }
  return true;
}

bool RowScan::finish(Batch& batch) const {
  CrossedRows& found = batch.found;
  kernels_->cross_rows(batch.triangles, batch.strips.data(), batch.strip_count, batch.space, found);
  batch.strip_count = 0;
  for (int n = 0; n < found.count;) {
    const int end = std::min(found.count, n + static_cast<int>(CrossingList::kMostAtOnce));
    FoundCrossing* to = batch.list.add(end - n);
    if (!to) return false;
    for (; n < end; ++n, ++to)
      *to = FoundCrossing::make(static_cast<std::uint32_t>(static_cast<std::int32_t>(found.row[n])),
                                static_cast<std::uint32_t>(static_cast<std::int32_t>(found.past[n])));
  }
  std::optional<RayTriangle> ray;
  std::int32_t of_ray = -1;
  for (int n = 0; n < found.unsure_count; ++n) {
    const RowStrip& strip = batch.strips[found.unsure[n] / RowStrip::kMostRows];
    const auto row = static_cast<std::int32_t>(found.unsure[n] % RowStrip::kMostRows);
    const auto [j, k] = batch.row_of(strip.triangle, strip.p + row % strip.width, strip.q + row / strip.width);
    const std::size_t triangle = batch.numbers[static_cast<std::size_t>(strip.triangle)];
    if (std::exchange(of_ray, strip.triangle) != strip.triangle) ray.emplace(mesh_.mesh.corners(triangle));
    if (!add_exactly(triangle, *ray, j, k, batch)) return false;
  }
  return true;
}

bool RowScan::add_all_exactly(std::size_t triangle, Batch& batch) const {
  if (mesh_.use_of(triangle) == 0) return true;
  const std::array<Vec3, 3> t = mesh_.mesh.corners(triangle);
  const auto [low_y, high_y] = std::minmax({t[0].y, t[1].y, t[2].y});
  const auto [low_z, high_z] = std::minmax({t[0].z, t[1].z, t[2].z});
  const RowWindow& window = batch.window;
  return add_rows_exactly(
      triangle,
      {{std::max(window.begin[0], y_.first_from(low_y)), std::max(window.begin[1], z_.first_from(low_z))},
       {std::min(window.end[0], y_.first_from(high_y)), std::min(window.end[1], z_.first_from(high_z))}},
      batch);
}

bool RowScan::add_rows_exactly(std::size_t triangle, const RowWindow& rows, Batch& batch) const {
  const RayTriangle ray(mesh_.mesh.corners(triangle));
  for (std::int64_t k = rows.begin[1]; k < rows.end[1]; ++k)
    for (std::int64_t j = rows.begin[0]; j < rows.end[0]; ++j)
      if (!add_exactly(triangle, ray, j, k, batch)) return false;
  return true;
}

bool RowScan::add_exactly(std::size_t triangle, const RayTriangle& ray, std::int64_t j, std::int64_t k,
                          Batch& batch) const {
  const double y = y_.at(j), z = z_.at(k);
  ExactSigns signs;
  const int crossing = ray.crossing(y, z, signs);
  if (crossing == 0) return true;
  const std::int64_t past = first_past(ray, x_, y, z, crossing, signs);
  if (past == x_.size()) return true;
  return batch.add_crossing(j, k, past, crossing * mesh_.use_of(triangle) < 0);
}

}  // namespace standoff
