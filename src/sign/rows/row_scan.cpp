// SPDX-License-Identifier: Apache-2.0
#include "sign/rows/row_scan.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "core/tile_count.h"
#include "sign/rows/ray_crossing.h"
#include "sign/signs.h"

namespace standoff {
namespace {

using cpu::CrossedRows;
using cpu::RowPatch;

// The search for rows takes a corner to be off by this much, in samples: far more than by rounding.
constexpr double kNearRow = 0x1p-16;

// y and z, side by side in a register.
using Pair = double __attribute__((vector_size(16)));
using PairOfInts = std::int64_t __attribute__((vector_size(16)));

Pair least(Pair a, Pair b) { return a < b ? a : b; }
Pair largest(Pair a, Pair b) { return a > b ? a : b; }

Pair one_where(PairOfInts mask) { return reinterpret_cast<Pair>(mask & reinterpret_cast<PairOfInts>(Pair{1, 1})); }
bool both(PairOfInts mask) { return (mask[0] & mask[1]) != 0; }
// Adds a number so large that the sum has no room for fractions. Requires |x| < 2^51.
template <class Number>
Number rounded_to_nearest(Number x) {
  return (x + 0x1.8p52) - 0x1.8p52;
}
Pair rounded_down(Pair x) {
  const Pair nearest = rounded_to_nearest(x);
  return nearest - one_where(nearest > x);
}
double rounded_down(double x) {
  const double nearest = rounded_to_nearest(x);
  return nearest - (nearest > x ? 1.0 : 0.0);
}
RowPatch::Across across(Pair at) { return {static_cast<float>(at[0]), static_cast<float>(at[1])}; }

template <bool kPacked>
Vec3 corners_x(const MeshView& mesh, std::size_t triangle) {
  const auto x = [&](std::size_t n) {
    if constexpr (kPacked) {
      const auto vertex = detail::load<std::uint32_t>(mesh.triangles.data() + sizeof(Triangle) * triangle + 4 * n);
      return detail::load<double>(mesh.vertices.data() + sizeof(Vec3) * vertex);
    } else {
      return mesh.corner(triangle, static_cast<int>(n)).x;
    }
  };
  return {x(0), x(1), x(2)};
}

template <bool kPacked>
Pair corner_yz(const MeshView& mesh, std::size_t triangle, std::size_t n) {
  if constexpr (kPacked) {
    const auto vertex = detail::load<std::uint32_t>(mesh.triangles.data() + sizeof(Triangle) * triangle + 4 * n);
    return detail::load<Pair>(mesh.vertices.data() + sizeof(Vec3) * vertex + sizeof(double));
  } else {
    const Vec3 corner = mesh.corner(triangle, static_cast<int>(n));
    return Pair{corner.y, corner.z};
  }
}

// The place of each row in patches of each width.
struct RowInPatch {
  std::uint8_t p, q;
};
using RowsInPatch = std::array<std::array<RowInPatch, RowPatch::kMostRows>, RowPatch::kMostWidth + 1>;
constexpr RowsInPatch kRowsInPatch = [] {
  RowsInPatch rows{};
  for (std::size_t width = 1; width < rows.size(); ++width)
    for (std::size_t n = 0; n < rows[width].size(); ++n)
      rows[width][n] = {static_cast<std::uint8_t>(n % width), static_cast<std::uint8_t>(n / width)};
  return rows;
}();

double least(double a, double b, double c) { return std::min(std::min(a, b), c); }
double largest(double a, double b, double c) { return std::max(std::max(a, b), c); }

// Rows p < width that a triangle may cross in the plane q: between the cuts of its sides.
struct ScanSpan {
  std::int64_t begin, end;
};
ScanSpan span_in_plane(const RowPatch& t, double q, double slack, std::int64_t width) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (int n = 0; n < 3; ++n) {
    const int m = (n + 1) % 3;
    const double q0 = t.at[n].q, q1 = t.at[m].q, p0 = t.at[n].p, p1 = t.at[m].p;
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
  return {static_cast<std::int64_t>(begin), static_cast<std::int64_t>(end)};
}

}  // namespace

// Patches that wait for the kernel, and the places of their rows.
struct RowScan::Batch {
  Batch(const RowWindow& rows, CrossingList& to, std::int64_t tiles_along_y)
      : window(rows),
        list(to),
        tiles_y(tiles_along_y),
        first_tiles(rows.begin[0] / kTileSide + tiles_along_y * (rows.begin[1] / kTileSide)) {}

  const RowWindow& window;
  CrossingList& list;
  std::int64_t tiles_y, first_tiles;  // tiles of the grid along y, and the number of the window's first row of tiles
  int count = 0;
  std::array<RowPatch, CrossedRows::kMostPatches> patches;
  std::array<Place, CrossedRows::kMostPatches> places;
  CrossedRows found;

  // Gives the patch in the next place these rows, from (p, q) on; `place` is the place of (0, 0).
  void add(std::int64_t p, std::int64_t q, const Extent& rows, const Place& place) {
    RowPatch& patch = patches[static_cast<std::size_t>(count)];
    patch.first = {static_cast<float>(p), static_cast<float>(q)};
    patch.width = static_cast<std::int32_t>(rows.columns);
    patch.height = static_cast<std::int32_t>(rows.planes);
    places[static_cast<std::size_t>(count++)] = {place.triangle, place.base, place.j + p, place.k + q};
  }
  // The row (j, k) that a number in `found` stands for.
  std::array<std::int64_t, 2> row_of(std::uint32_t number) const {
    const std::uint32_t row = number % RowPatch::kMostRows, which = number / RowPatch::kMostRows;
    const Place& place = places[which];
    if (patches[which].height == 1) return {place.j + row, place.k};
    const RowInPatch& at = kRowsInPatch[static_cast<std::size_t>(patches[which].width)][row];
    return {place.j + at.p, place.k + at.q};
  }
  void add_crossing(std::int64_t j, std::int64_t k, std::int64_t past, bool enters, bool counts) const {
    const auto y = static_cast<std::uint64_t>(j), z = static_cast<std::uint64_t>(k);
    const std::uint64_t tiles =
        y / kTileSide + static_cast<std::uint64_t>(tiles_y) * (z / kTileSide) - static_cast<std::uint64_t>(first_tiles);
    list.add(FoundCrossing::make(InsideRows::kRows * tiles + y % kTileSide + kTileSide * (z % kTileSide),
                                 static_cast<std::uint64_t>(past), enters),
             counts);
  }
};

RowScan::RowScan(const OrientedMesh& mesh, const Grid& grid, Simd simd)
    : mesh_(mesh),
      grid_(grid),
      x_(axis_of(grid, 0)),
      y_(axis_of(grid, 1)),
      z_(axis_of(grid, 2)),
      kernels_(&cpu::sign_kernels_for(simd)) {
  // Three operations turn a corner into samples, and each adds an error of 2^-53 times at most size + kMost. Two
  // roundings move a sample off its place, by 2^-53 times at most size and size + |origin| / spacing.
  const auto slack = [](const GridAxis& axis) {
    return 0x1p-50 *
           (static_cast<double>(axis.first + axis.size) + RowPatch::kMost + std::abs(axis.origin) / axis.spacing);
  };
  slack_ = largest(slack(axis_of(grid, 0)), slack(axis_of(grid, 1)), slack(axis_of(grid, 2)));
  const double per = largest(1 / grid.spacing.x, 1 / grid.spacing.y, 1 / grid.spacing.z);
  filters_ = slack_ < kNearRow / 2 && per < std::numeric_limits<double>::infinity();
}

bool RowScan::scan(std::size_t first, std::size_t end, const RowWindow& window, CrossingList& list) const {
  Batch batch(window, list, tiles_along(grid_.size.y));
  if (!filters_) {
    for (std::size_t t = first; t < end; ++t)
      if (!add_all_exactly(t, window, batch)) return false;
    return true;
  }
  const bool is_packed = mesh_.mesh.triangles.packed() && mesh_.mesh.vertices.packed();
  return (is_packed ? scan_filtered<true>(first, end, batch) : scan_filtered<false>(first, end, batch)) &&
         finish(batch);
}

template <bool kPacked>
bool RowScan::scan_filtered(std::size_t first, std::size_t end, Batch& batch) const {
  const RowWindow& window = batch.window;
  const Pair origin{grid_.origin.y, grid_.origin.z}, spacing{grid_.spacing.y, grid_.spacing.z},
      first_row{double(grid_.first.y), double(grid_.first.z)},
      per = 1 / spacing, before{1 - kNearRow, 1 - kNearRow}, after{1 + kNearRow, 1 + kNearRow},
      window_begin{double(window.begin[0]), double(window.begin[1])},
      window_end{double(window.end[0]), double(window.end[1])}, none{0, 0};
  const double size_x = static_cast<double>(x_.size());
  const auto rows_to = [&](Pair value) { return (value - origin) * per - first_row; };
  const auto coordinate = [&](Pair row) { return origin + spacing * (first_row + row); };
  for (std::size_t t = first; t < end; ++t) {
    const Pair a = corner_yz<kPacked>(mesh_.mesh, t, 0), b = corner_yz<kPacked>(mesh_.mesh, t, 1),
               c = corner_yz<kPacked>(mesh_.mesh, t, 2);
    const Pair low = least(least(a, b), c), high = largest(largest(a, b), c);
    // Take the first rows after low - kNearRow and after high + kNearRow: at most one too many at each end.
    Pair begin = rounded_down(largest(rows_to(low) + before, window_begin)),
         past = rounded_down(largest(least(rows_to(high) + after, window_end), none));
    if (!both(begin < past)) continue;
    // Make the range half open: a row at the largest y or z passes beside the triangle.
    begin += one_where(coordinate(begin) < low);
    past -= one_where(coordinate(past - 1) >= high);
    if (!both(begin < past) || mesh_.use_of(t) == 0) continue;

    const Vec3 x = corners_x<kPacked>(mesh_.mesh, t);
    const double xs[3] = {x_.to_samples(x.x), x_.to_samples(x.y), x_.to_samples(x.z)};
    const double low_x = least(xs[0], xs[1], xs[2]);
    if (low_x > size_x + 1) continue;
    if (batch.count == CrossedRows::kMostPatches && !finish(batch)) return false;
    // Write coordinates relative to a sample near the triangle, directly into the batch: a copy would wait for them.
    RowPatch& patch = batch.patches[static_cast<std::size_t>(batch.count)];
    const double base = rounded_down(std::max(low_x, -0x1p40));
    const double x0 = xs[0] - base, x1 = xs[1] - base, x2 = xs[2] - base;
    const Pair at0 = rows_to(a) - begin, at1 = rows_to(b) - begin, at2 = rows_to(c) - begin;
    const double most_x = std::max(largest(x0, x1, x2), 1.0);  // none is negative
    const Pair extent = past - begin,
               most = largest(largest(largest(at0, -at0), largest(at1, -at1)),
                              largest(largest(at2, -at2), largest(extent, Pair{slack_, slack_})));
    const Place place{t, static_cast<std::int64_t>(base), static_cast<std::int64_t>(begin[0]),
                      static_cast<std::int64_t>(begin[1])};
    const Extent rows{static_cast<std::int64_t>(extent[0]), static_cast<std::int64_t>(extent[1])};
    if (!(largest(most_x, most[0], most[1]) < RowPatch::kMost)) {
      if (!add_rows(place, rows, batch)) return false;
      continue;
    }
    patch.x[0] = static_cast<float>(x0);
    patch.x[1] = static_cast<float>(x1);
    patch.x[2] = static_cast<float>(x2);
    patch.at[0] = across(at0);
    patch.at[1] = across(at1);
    patch.at[2] = across(at2);
    patch.most_x = static_cast<float>(most_x);
    patch.most = across(most);
    patch.slack = static_cast<float>(slack_);
    if (rows.columns <= RowPatch::kMostWidth && rows.columns * rows.planes <= RowPatch::kMostRows)
      batch.add(0, 0, rows, place);
    else if (!add_strips(RowPatch(patch), rows, place, batch))
      return false;
  }
  return true;
}

// Adds a triangle with too many rows for one patch.
bool RowScan::add_strips(const RowPatch& patch, const Extent& rows, const Place& place, Batch& batch) const {
  const auto [columns, planes] = rows;
  const auto add = [&](std::int64_t p, std::int64_t q, std::int64_t width, std::int64_t height) {
    if (batch.count == CrossedRows::kMostPatches && !finish(batch)) return false;
    batch.patches[static_cast<std::size_t>(batch.count)] = patch;
    batch.add(p, q, {width, height}, place);
    return true;
  };
  if (columns <= RowPatch::kMostWidth) {
    const std::int64_t at_once = RowPatch::kMostRows / columns;
    for (std::int64_t q = 0; q < planes; q += at_once)
      if (!add(0, q, columns, std::min(at_once, planes - q))) return false;
    return true;
  }
  const double slack = slack_ + 0x1p-23 * std::max(double{patch.most.p}, double{patch.most.q});  // rounded to float
  for (std::int64_t q = 0; q < planes; ++q) {
    const ScanSpan span = span_in_plane(patch, static_cast<double>(q), slack, columns);
    for (std::int64_t p = span.begin; p < span.end; p += RowPatch::kMostRows)
      if (!add(p, q, std::min<std::int64_t>(RowPatch::kMostRows, span.end - p), 1)) return false;
  }
  return true;
}

bool RowScan::finish(Batch& batch) const {
  CrossedRows& found = batch.found;
  kernels_->cross_rows(batch.patches.data(), batch.count, found);
  batch.count = 0;
  for (int n = 0; n < found.count;) {
    const std::ptrdiff_t room = std::min<std::ptrdiff_t>(found.count - n, CrossingList::kMostAtOnce);
    if (!batch.list.make_room(room)) return false;
    for (const int end = n + static_cast<int>(room); n < end; ++n) {
      const std::uint32_t which = found.row[n] / RowPatch::kMostRows;
      const Place& place = batch.places[which];
      const auto [j, k] = batch.row_of(found.row[n]);
      const std::int64_t past = std::max<std::int64_t>(0, place.base + static_cast<std::int64_t>(found.past[n]));
      batch.add_crossing(j, k, past, found.leaves[which] != (mesh_.use_of(place.triangle) > 0), past < x_.size());
    }
  }
  for (int n = 0; n < found.unsure_count; ++n) {
    const std::size_t triangle = batch.places[found.unsure[n] / RowPatch::kMostRows].triangle;
    const auto [j, k] = batch.row_of(found.unsure[n]);
    if (!add_exactly(triangle, mesh_.mesh.corners(triangle), j, k, batch)) return false;
  }
  return true;
}

bool RowScan::add_all_exactly(std::size_t triangle, const RowWindow& window, Batch& batch) const {
  if (mesh_.use_of(triangle) == 0) return true;
  const std::array<Vec3, 3> t = mesh_.mesh.corners(triangle);
  const std::int64_t j = std::max(window.begin[0], y_.first_from(least(t[0].y, t[1].y, t[2].y))),
                     k = std::max(window.begin[1], z_.first_from(least(t[0].z, t[1].z, t[2].z)));
  return add_rows({triangle, 0, j, k},
                  {std::min(window.end[0], y_.first_from(largest(t[0].y, t[1].y, t[2].y))) - j,
                   std::min(window.end[1], z_.first_from(largest(t[0].z, t[1].z, t[2].z))) - k},
                  batch);
}

bool RowScan::add_rows(const Place& place, const Extent& rows, Batch& batch) const {
  const std::array<Vec3, 3> corners = mesh_.mesh.corners(place.triangle);
  for (std::int64_t q = 0; q < rows.planes; ++q)
    for (std::int64_t p = 0; p < rows.columns; ++p)
      if (!add_exactly(place.triangle, corners, place.j + p, place.k + q, batch)) return false;
  return true;
}

bool RowScan::add_exactly(std::size_t triangle, const std::array<Vec3, 3>& corners, std::int64_t j, std::int64_t k,
                          Batch& batch) const {
  const RayTriangle ray(corners);
  const double y = y_.at(j), z = z_.at(k);
  const int crossing = ray.crossing(y, z);
  if (crossing == 0) return true;
  const std::int64_t past = x_.first(ray.crossing_x(y, z), [&](std::int64_t n) {
    return ray.is_past({x_.at(n), y, z}, crossing);
  });
  if (past == x_.size()) return true;
  if (!batch.list.make_room(1)) return false;
  batch.add_crossing(j, k, past, crossing * mesh_.use_of(triangle) < 0, true);
  return true;
}

}  // namespace standoff
