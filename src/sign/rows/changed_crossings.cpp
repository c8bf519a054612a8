// SPDX-License-Identifier: Apache-2.0
#include "sign/rows/changed_crossings.h"

#include <tbb/parallel_for.h>

#include <iterator>
#include <limits>
#include <span>
#include <stdexcept>
#include <utility>

namespace standoff {

ChangedCrossings::ChangedCrossings(const OrientedMesh& before, const OrientedMesh& after, const Grid& grid,
                                   ProgressMeter& progress)
    : size_(grid.size) {
  constexpr std::int64_t kAny = std::numeric_limits<std::int64_t>::max();
  RowCrossings old(before, grid, progress, kAny), now(after, grid, progress, kAny);
  const std::int64_t tiles_y = tiles_along(size_.y);
  for (std::int64_t n = 0; n < old.rows_of_tiles();) {
    const std::int64_t end = std::min(old.load(n), now.load(n));
    for (; n < end; ++n) {
      const std::span<const RowCrossing> was = old.of_tiles(n % tiles_y, n / tiles_y),
                                         is = now.of_tiles(n % tiles_y, n / tiles_y);
      if (std::ranges::equal(was, is)) continue;
      OfTiles changed{static_cast<std::size_t>(n), {}, {}};
      std::ranges::set_difference(was, is, std::back_inserter(changed.gone));
      std::ranges::set_difference(is, was, std::back_inserter(changed.come));
      tiles_.push_back(std::move(changed));
    }
  }
}

KeptCrossings::KeptCrossings(const OrientedMesh& mesh, const Grid& grid, WindingRule rule, ProgressMeter& progress,
                             std::int64_t bytes)
    : tiles_y_(tiles_along(grid.size.y)), rule_(rule) {
  RowCrossings all(mesh, grid, progress, bytes);
  of_tiles_.resize(static_cast<std::size_t>(all.rows_of_tiles()));
  for (std::int64_t n = 0; n < all.rows_of_tiles();)
    for (const std::int64_t end = all.load(n); n < end; ++n) {
      const std::span<const RowCrossing> these = all.of_tiles(n % tiles_y_, n / tiles_y_);
      count_ += std::ssize(these);
      if (this->bytes() > bytes) return;
      of_tiles_[static_cast<std::size_t>(n)].assign(these.begin(), these.end());
    }
}

void KeptCrossings::follow(const ChangedCrossings& changed) {
  tbb::parallel_for(std::size_t{0}, changed.tiles().size(), [&](std::size_t n) {
    const ChangedCrossings::OfTiles& tiles = changed.tiles()[n];
    std::vector<RowCrossing>& all = of_tiles_[tiles.number];
    std::vector<RowCrossing> left, now;
    std::ranges::set_difference(all, tiles.gone, std::back_inserter(left));
    if (left.size() + tiles.gone.size() != all.size())
      throw std::logic_error("a crossing that goes was not among those that are kept");
    now.reserve(left.size() + tiles.come.size());
    std::ranges::merge(left, tiles.come, std::back_inserter(now));
    all = std::move(now);
  });
  for (const ChangedCrossings::OfTiles& tiles : changed.tiles())
    count_ += std::ssize(tiles.come) - std::ssize(tiles.gone);
}

}  // namespace standoff
