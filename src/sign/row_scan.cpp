// SPDX-License-Identifier: Apache-2.0
#include "sign/row_scan.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "core/tile_count.h"
#include "sign/inside_rows.h"
#include "sign/ray_crossing.h"

namespace standoff {
namespace {

using cpu::CrossedRows;
using cpu::RowPatch;

constexpr std::int64_t kSide = InsideRows::kSide;

// Where rows are looked for, a corner is taken to be off by this much, in samples: far more than by rounding.
constexpr double kNearRow = 0x1p-16;

// y and z, side by side in a register.
using Pair = double __attribute__((vector_size(16)));
using PairOfInts = std::int64_t __attribute__((vector_size(16)));

Pair least(Pair a, Pair b) { return a < b ? a : b; }
Pair largest(Pair a, Pair b) { return a > b ? a : b; }

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

double least(double a, double b, double c) { return std::min(std::min(a, b), c); }
double largest(double a, double b, double c) { return std::max(std::max(a, b), c); }

// Rows p < width that a triangle may cross in the plane q: between the cuts of its sides.
struct Span {
  std::int64_t begin, end;
};
Span span_in_plane(const RowPatch& t, double q, double slack, std::int64_t width) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (int n = 0; n < 3; ++n) {
    const int m = (n + 1) % 3;
    const double q0 = t.q[n], q1 = t.q[m], p0 = t.p[n], p1 = t.p[m];
    if (q < std::min(q0, q1) - slack || q > std::max(q0, q1) + slack) continue;
    const double rise = q1 - q0, run = p1 - p0;
    double from = p0, to = p1;
    // A cut that is off by less than half a row; else all of the side.
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

// Patches that wait for the kernel, and where their rows are.
struct RowScan::Batch {
  struct Place {
    std::size_t triangle;
    std::int64_t base, j, k;  // of x = 0, and of the patch's first row
  };
  Batch(const RowWindow& rows, CrossingList& to, std::int64_t tiles_along_y)
      : window(rows),
        list(to),
        tiles_y(tiles_along_y),
        first_tiles(rows.begin[0] / kSide + tiles_along_y * (rows.begin[1] / kSide)) {}

  const RowWindow& window;
  CrossingList& list;
  std::int64_t tiles_y, first_tiles;  // of the grid, and the number of the window's first row of tiles
  int count = 0;
  std::array<RowPatch, CrossedRows::kMostPatches> patches;
  std::array<Place, CrossedRows::kMostPatches> places;
  CrossedRows found;

  void add(std::int64_t j, std::int64_t k, std::int64_t past, bool enters, bool counts) const {
    const auto y = static_cast<std::uint64_t>(j), z = static_cast<std::uint64_t>(k);
    const std::uint64_t tiles =
        y / kSide + static_cast<std::uint64_t>(tiles_y) * (z / kSide) - static_cast<std::uint64_t>(first_tiles);
    list.add(FoundCrossing::make(InsideRows::kRows * tiles + y % kSide + kSide * (z % kSide),
                                 static_cast<std::uint64_t>(past), enters),
             counts);
  }
};

RowScan::RowScan(const OrientedMesh& mesh, const Grid& grid)
    : mesh_(mesh),
      grid_(grid),
      x_{grid.origin.x, grid.spacing.x, grid.size.x},
      y_{grid.origin.y, grid.spacing.y, grid.size.y},
      z_{grid.origin.z, grid.spacing.z, grid.size.z},
      kernels_(&cpu::sign_kernels_for(Simd::automatic)) {
  // A corner becomes samples by three operations, of which each adds 2^-53 of at most size + kMost; a sample is off its
  // place by two roundings, of at most size and of size + |origin| / spacing.
  const auto slack = [](double origin, double spacing, std::int64_t size) {
    return 0x1p-50 * (static_cast<double>(size) + RowPatch::kMost + std::abs(origin) / spacing);
  };
  slack_ = largest(slack(grid.origin.x, grid.spacing.x, grid.size.x), slack(grid.origin.y, grid.spacing.y, grid.size.y),
                   slack(grid.origin.z, grid.spacing.z, grid.size.z));
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
      per = 1 / spacing, before{1 - kNearRow, 1 - kNearRow}, after{1 + kNearRow, 1 + kNearRow},
      window_begin{double(window.begin[0]), double(window.begin[1])},
      window_end{double(window.end[0]), double(window.end[1])}, none{0, 0};
  for (std::size_t t = first; t < end; ++t) {
    const Pair a = corner_yz<kPacked>(mesh_.mesh, t, 0), b = corner_yz<kPacked>(mesh_.mesh, t, 1),
               c = corner_yz<kPacked>(mesh_.mesh, t, 2);
    const Pair low = least(least(a, b), c), high = largest(largest(a, b), c);
    // The first rows after low - kNearRow and after high + kNearRow: one too many at each end, at most.
    const Pair from = largest((low - origin) * per + before, window_begin),
               to = largest(least((high - origin) * per + after, window_end), none);
    PairOfInts begin = __builtin_convertvector(from, PairOfInts), past = __builtin_convertvector(to, PairOfInts);
    PairOfInts some = begin < past;
    if ((some[0] & some[1]) == 0) continue;
    // Half open: a row at the largest y or z passes beside the triangle. Lanes of comparisons are -1 or 0.
    begin -= origin + spacing * __builtin_convertvector(begin, Pair) < low;
    past += origin + spacing * __builtin_convertvector(past - 1, Pair) >= high;
    some = begin < past;
    if ((some[0] & some[1]) == 0 || mesh_.use_of(t) == 0) continue;
    if (!add_filtered(t, {{begin[0], begin[1]}, {past[0], past[1]}}, batch)) return false;
  }
  return true;
}

bool RowScan::add_filtered(std::size_t triangle, const Rows& rows, Batch& batch) const {
  const std::array<Vec3, 3> t = mesh_.mesh.corners(triangle);
  const double x[3] = {x_.to_samples(t[0].x), x_.to_samples(t[1].x), x_.to_samples(t[2].x)};
  const double low_x = least(x[0], x[1], x[2]), width = static_cast<double>(rows.end[0] - rows.begin[0]),
               height = static_cast<double>(rows.end[1] - rows.begin[1]);
  if (low_x > static_cast<double>(x_.size()) + 1) return true;
  // All relative to a sample near the triangle.
  const double base = std::floor(std::max(low_x, -0x1p40)), j = static_cast<double>(rows.begin[0]),
               k = static_cast<double>(rows.begin[1]);
  RowPatch patch;
  double most_x = 1, most_p = std::max(width, slack_), most_q = std::max(height, slack_);
  for (std::size_t n = 0; n < 3; ++n) {
    const double local_x = x[n] - base, p = y_.to_samples(t[n].y) - j, q = z_.to_samples(t[n].z) - k;
    most_x = std::max(most_x, std::abs(local_x));
    most_p = std::max(most_p, std::abs(p));
    most_q = std::max(most_q, std::abs(q));
    patch.x[n] = static_cast<float>(local_x);
    patch.p[n] = static_cast<float>(p);
    patch.q[n] = static_cast<float>(q);
  }
  if (!(largest(most_x, most_p, most_q) < RowPatch::kMost)) return add_rows(triangle, t, rows, batch);
  patch.most_x = static_cast<float>(most_x);
  patch.most_p = static_cast<float>(most_p);
  patch.most_q = static_cast<float>(most_q);
  patch.slack = static_cast<float>(slack_);

  const auto add = [&](std::int64_t p, std::int64_t q, std::int64_t patch_width, std::int64_t patch_height) {
    if (batch.count == CrossedRows::kMostPatches && !finish(batch)) return false;
    RowPatch& one = batch.patches[static_cast<std::size_t>(batch.count)];
    one = patch;
    one.first_p = static_cast<float>(p);
    one.first_q = static_cast<float>(q);
    one.width = static_cast<std::int32_t>(patch_width);
    one.height = static_cast<std::int32_t>(patch_height);
    batch.places[static_cast<std::size_t>(batch.count++)] = {triangle, static_cast<std::int64_t>(base),
                                                             rows.begin[0] + p, rows.begin[1] + q};
    return true;
  };
  const std::int64_t columns = rows.end[0] - rows.begin[0], planes = rows.end[1] - rows.begin[1];
  if (columns <= RowPatch::kMostWidth) {
    const std::int64_t at_once = RowPatch::kMostRows / columns;
    for (std::int64_t q = 0; q < planes; q += at_once)
      if (!add(0, q, columns, std::min(at_once, planes - q))) return false;
    return true;
  }
  const double slack = slack_ + 0x1p-23 * std::max(most_p, most_q);  // rounded to float
  for (std::int64_t q = 0; q < planes; ++q) {
    const Span span = span_in_plane(patch, static_cast<double>(q), slack, columns);
    for (std::int64_t p = span.begin; p < span.end; p += RowPatch::kMostRows)
      if (!add(p, q, std::min<std::int64_t>(RowPatch::kMostRows, span.end - p), 1)) return false;
  }
  return true;
}

bool RowScan::finish(Batch& batch) const {
  CrossedRows& found = batch.found;
  kernels_->cross_rows(batch.patches.data(), batch.count, found);
  batch.count = 0;
  // The row (j, k) of a number of CrossedRows.
  const auto row_of = [&](std::uint32_t number, const Batch::Place& place, const RowPatch& patch) {
    const std::uint32_t row = number % RowPatch::kMostRows, width = static_cast<std::uint32_t>(patch.width);
    return std::array<std::int64_t, 2>{place.j + row % width, place.k + row / width};
  };
  for (int n = 0; n < found.count;) {
    const std::ptrdiff_t room = std::min<std::ptrdiff_t>(found.count - n, CrossingList::kBlock);
    if (!batch.list.make_room(room)) return false;
    for (const int end = n + static_cast<int>(room); n < end; ++n) {
      const std::uint32_t number = found.row[n], which = number / RowPatch::kMostRows;
      const Batch::Place& place = batch.places[which];
      const auto [j, k] = row_of(number, place, batch.patches[which]);
      const std::int64_t past = std::max<std::int64_t>(0, place.base + static_cast<std::int64_t>(found.past[n]));
      const bool enters = found.leaves[which] != (mesh_.use_of(place.triangle) > 0);
      batch.add(j, k, past, enters, past < x_.size());
    }
  }
  for (int n = 0; n < found.unsure_count; ++n) {
    const std::uint32_t number = found.unsure[n], which = number / RowPatch::kMostRows;
    const Batch::Place& place = batch.places[which];
    const auto [j, k] = row_of(number, place, batch.patches[which]);
    if (!add_exactly(place.triangle, mesh_.mesh.corners(place.triangle), j, k, batch)) return false;
  }
  return true;
}

bool RowScan::add_all_exactly(std::size_t triangle, const RowWindow& window, Batch& batch) const {
  if (mesh_.use_of(triangle) == 0) return true;
  const std::array<Vec3, 3> t = mesh_.mesh.corners(triangle);
  const std::int64_t begin_y = y_.first_from(least(t[0].y, t[1].y, t[2].y)),
                     begin_z = z_.first_from(least(t[0].z, t[1].z, t[2].z)),
                     end_y = y_.first_from(largest(t[0].y, t[1].y, t[2].y)),
                     end_z = z_.first_from(largest(t[0].z, t[1].z, t[2].z));
  return add_rows(triangle, t,
                  {{std::max(begin_y, window.begin[0]), std::max(begin_z, window.begin[1])},
                   {std::min(end_y, window.end[0]), std::min(end_z, window.end[1])}},
                  batch);
}

bool RowScan::add_rows(std::size_t triangle, const std::array<Vec3, 3>& corners, const Rows& rows, Batch& batch) const {
  for (std::int64_t k = rows.begin[1]; k < rows.end[1]; ++k)
    for (std::int64_t j = rows.begin[0]; j < rows.end[0]; ++j)
      if (!add_exactly(triangle, corners, j, k, batch)) return false;
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
  batch.add(j, k, past, crossing * mesh_.use_of(triangle) < 0, true);
  return true;
}

}  // namespace standoff
