// SPDX-License-Identifier: Apache-2.0
#include "sign/rows/row_crossings.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <stdexcept>
#include <utility>

#include "core/threads.h"
#include "core/tile_count.h"

namespace standoff {
namespace {

constexpr std::int64_t kTileRows = InsideRows::kRows;
constexpr std::int64_t kEntries = CrossingList::kBlock - CrossingList::kMostAtOnce;  // a block has at least this many
// A block, its places in lists that grow, and its crossings when they are sorted.
constexpr std::int64_t kBlockBytes = CrossingList::kBlock * (sizeof(FoundCrossing) + sizeof(RowCrossing)) + 64;
// In find_row_by_row(): a vector that grows is held twice, and half as large.
constexpr std::int64_t kGrowth = 3;
constexpr std::int64_t kMostRowsOfTiles = std::int64_t{1} << (FoundCrossing::kRowBits - 6);  // of a window
// Counters of the counting sort: parts of the input that are sorted side by side have counters of their own.
constexpr std::int64_t kMostCounters = std::int64_t{1} << 19;

RowCrossing crossing_of(const FoundCrossing& found) {
  return RowCrossing::make(found.row() % kTileRows, static_cast<std::int64_t>(found.past()), found.enters() ? 1 : -1);
}

// Sorts crossings by `count` rows of tiles: row of tiles n gets crossings[begin[n]] to crossings[begin[n + 1] - 1].
// Counts the crossings of each part of the lists, then gives each part its own places.
void sort_by_tiles(PerThread<CrossingList>& lists, std::size_t count, std::vector<std::size_t>& begin,
                   std::vector<RowCrossing>& crossings) {
  std::vector<std::vector<const CrossingList*>> parts;
  const std::int64_t most_parts = std::max<std::int64_t>(1, kMostCounters / static_cast<std::int64_t>(count));
  std::size_t lists_seen = 0;
  lists.for_each([&](const CrossingList& list) {
    if (std::ssize(parts) < most_parts) parts.emplace_back();
    parts[lists_seen++ % parts.size()].push_back(&list);
  });
  const auto for_each_found = [&](std::size_t part, const auto& use) {
    for (const CrossingList* list : parts[part])
      list->for_each_block([&](std::span<const FoundCrossing> block) {
        for (const FoundCrossing& one : block) use(one.row() / kTileRows, one);
      });
  };
  std::vector<std::vector<std::size_t>> next(parts.size());
  tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t part) {
    next[part].resize(count);
    for_each_found(part, [&](std::size_t tiles, const FoundCrossing&) { ++next[part][tiles]; });
  });
  begin.resize(count + 1);
  if (!parts.empty())
    begin[count] = places_from_counts(next, count, [&](std::size_t tiles, std::size_t place) { begin[tiles] = place; });
  crossings.resize(begin[count]);
  tbb::parallel_for(std::size_t{0}, parts.size(), [&](std::size_t part) {
    for_each_found(
        part, [&](std::size_t tiles, const FoundCrossing& one) { crossings[next[part][tiles]++] = crossing_of(one); });
  });
}

// Sorts the crossings of one row of tiles: few, and in some meshes many.
void sort(std::span<RowCrossing> crossings) {
  constexpr std::size_t kMost = 2048;
  if (crossings.size() < 2) return;
  if (crossings.size() > kMost) return std::sort(crossings.begin(), crossings.end());
  // Sort by row first, which leaves a few in each row in any order.
  std::array<RowCrossing, kMost> by_row;
  std::array<std::uint16_t, kTileRows + 1> end{};
  for (const RowCrossing& one : crossings) ++end[static_cast<std::size_t>(one.row()) + 1];
  for (std::size_t row = 0; row < kTileRows; ++row) end[row + 1] = static_cast<std::uint16_t>(end[row] + end[row + 1]);
  for (const RowCrossing& one : crossings) by_row[end[static_cast<std::size_t>(one.row())]++] = one;
  // Insert each among the crossings of its row.
  for (std::size_t n = 0; n < crossings.size(); ++n) {
    const RowCrossing one = by_row[n];
    std::size_t at = n;
    for (; at > 0 && one < crossings[at - 1]; --at) crossings[at] = crossings[at - 1];
    crossings[at] = one;
  }
}

}  // namespace

RowCrossings::RowCrossings(const OrientedMesh& mesh, const Grid& grid, ProgressMeter& progress)
    : RowCrossings(mesh, grid, progress, std::numeric_limits<std::int64_t>::max()) {
  load(0);
}

RowCrossings::RowCrossings(const OrientedMesh& mesh, const Grid& grid, ProgressMeter& progress, std::int64_t bytes,
                           Order order)
    : scan_(mesh, grid),
      order_(order),
      triangles_(mesh.mesh.triangles.size()),
      size_(grid.size),
      progress_(&progress),
      blocks_(std::max(bytes, least_bytes(static_cast<std::int64_t>(mesh.mesh.triangles.size()),
                                          tbb::this_task_arena::max_concurrency())) /
              kBlockBytes),
      tiles_y_(tiles_along(grid.size.y)),
      rows_of_tiles_(tiles_y_ * tiles_along(grid.size.z)),
      try_(std::min(rows_of_tiles_, kMostRowsOfTiles)) {}

std::int64_t RowCrossings::load(std::int64_t first) {
  if (const std::int64_t end = first_ + std::ssize(begin_) - 1; first >= first_ && first < end) return end;  // held
  // Try whole layers of tiles, or a part of one layer; then less, and at last row by row.
  for (;; try_ = std::max<std::int64_t>(1, try_ / 2)) {
    std::int64_t count = std::min(try_, rows_of_tiles_ - first);
    const std::int64_t in_layer = first % tiles_y_;
    count = in_layer == 0 && count >= tiles_y_ ? count - count % tiles_y_ : std::min(count, tiles_y_ - in_layer);
    if (find(first, count)) return first + count;
    if (count > 1) continue;
    find_row_by_row(first);
    return first + 1;
  }
}

bool RowCrossings::find(std::int64_t first, std::int64_t count) {
  first_ = first;
  begin_.clear();
  const std::int64_t ty = first % tiles_y_, tz = first / tiles_y_, layers = std::max<std::int64_t>(1, count / tiles_y_);
  const RowWindow window{
      {kTileSide * ty, kTileSide * tz},
      {std::min(size_.y, kTileSide * (ty + std::min(count, tiles_y_))), std::min(size_.z, kTileSide * (tz + layers))}};
  return find(window, static_cast<std::size_t>(count));
}

bool RowCrossings::find(const RowWindow& window, std::size_t count) {
  constexpr std::size_t kGrain = 4096, kMany = 1 << 16;
  crossings_ = std::vector<RowCrossing>();  // gives the memory back, which clear() does not
  BlockBudget budget(blocks_);
  PerThread<CrossingList> lists([&] { return CrossingList(budget, *progress_); });
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, triangles_, kGrain), [&](const auto& range) {
    // A range may be most of a large mesh.
    for (std::size_t first = range.begin(); first < range.end() && !budget.is_spent(); first += kGrain) {
      progress_->check();
      scan_.scan(first, std::min(first + kGrain, range.end()), window, lists.local());
    }
  });
  if (budget.is_spent()) return false;

  sort_by_tiles(lists, count, begin_, crossings_);
  if (order_ == Order::any) return true;
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 64), [&](const auto& range) {
    for (std::size_t n = range.begin(); n != range.end(); ++n) {
      if (n % 64 == 0 || begin_[n + 1] - begin_[n] > kMany) progress_->check();
      sort(std::span(crossings_).subspan(begin_[n], begin_[n + 1] - begin_[n]));
    }
  });
  return true;
}

// Adds up steps at the same sample. So the number of crossings is at most the number of samples, or a 2^17th of the
// number of triangles if that is more.
void RowCrossings::find_row_by_row(std::int64_t tiles) {
  std::vector<RowCrossing> all;
  const std::int64_t ty = tiles % tiles_y_, tz = tiles / tiles_y_;
  for (std::int64_t k = kTileSide * tz; k < std::min(size_.z, kTileSide * (tz + 1)); ++k)
    for (std::int64_t j = kTileSide * ty; j < std::min(size_.y, kTileSide * (ty + 1)); ++j) {
      if (!find(RowWindow{{j, k}, {j + 1, k + 1}}, 1)) throw std::logic_error("the crossings of one row do not fit");
      if (order_ == Order::any) sort(crossings_);
      const std::size_t row_begin = all.size();
      for (const RowCrossing& one : crossings_) {
        if (all.size() > row_begin && all.back().past() == one.past()) {
          const std::int64_t step = all.back().step() + one.step();
          if (std::abs(step) <= RowCrossing::kMostSteps) {
            all.back() = RowCrossing::make(static_cast<std::uint64_t>(one.row()), one.past(), step);
            continue;
          }
        }
        all.push_back(one);
      }
    }
  crossings_ = std::move(all);
  begin_ = {0, crossings_.size()};
}

double RowCrossings::expected_bytes(const OrientedMesh& mesh, const Grid& grid) {
  const double per_area = 1 / (grid.spacing.y * grid.spacing.z);
  const auto add = [&](const tbb::blocked_range<std::size_t>& range, double sum) {
    for (std::size_t t = range.begin(); t < range.end(); ++t) {
      const auto [a, b, c] = mesh.mesh.corners(t);
      sum += std::abs(cross(b - a, c - a).x) * (per_area / 2);
    }
    return sum;
  };
  const double crossings = tbb::parallel_deterministic_reduce(
      tbb::blocked_range<std::size_t>(0, mesh.mesh.triangles.size(), 1 << 16), 0.0, add, std::plus<>());
  return crossings * sizeof(FoundCrossing) + crossings * sizeof(RowCrossing);
}

std::int64_t RowCrossings::least_bytes(std::int64_t triangles, int threads) {
  return kBlockBytes * (triangles / kEntries + 1 + threads);
}

std::int64_t RowCrossings::other_bytes(std::int64_t triangles, const Grid& grid, int threads) {
  const std::int64_t rows_of_tiles = std::min(tiles_along(grid.size.y) * tiles_along(grid.size.z), kMostRowsOfTiles),
                     parts = std::clamp<std::int64_t>(kMostCounters / rows_of_tiles, 1, threads),
                     row_by_row = kGrowth * kTileRows *
                                  (std::min(grid.size.x, triangles) + triangles / RowCrossing::kMostSteps + 1);
  return 8 * ((parts + 1) * (rows_of_tiles + 1) + row_by_row);
}

}  // namespace standoff
