// SPDX-License-Identifier: Apache-2.0
// The crossings of a grid's rows with a closed mesh of which a part moves: what changes, and all of them, kept.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/progress.h"
#include "core/tile_count.h"
#include "sign/oriented_mesh.h"
#include "sign/rows/row_crossings.h"
#include "sign/signs.h"
#include "standoff/grid.h"
#include "standoff/sign.h"

namespace standoff {

/// The crossings that go and come with triangles that move.
class ChangedCrossings {
 public:
  /// Of the 64 rows of tiles number ty + tiles_y * tz, sorted.
  struct OfTiles {
    std::size_t number;
    std::vector<RowCrossing> gone, come;
  };

  ChangedCrossings() = default;
  /// `before`, `after`: the triangles that moved, as they were and as they are. Runs on the threads of the calling TBB
  /// arena. Throws Error{interrupted}.
  ChangedCrossings(const OrientedMesh& before, const OrientedMesh& after, const Grid& grid, ProgressMeter& progress);

  /// Those that have any, ascending.
  const std::vector<OfTiles>& tiles() const { return tiles_; }

  /// Calls use(j, k, begin, end) for all samples whose winding number changes: samples begin to end - 1 of row (j, k).
  template <class Use>
  void each_changed(const Use& use) const;

 private:
  Size3 size_;
  std::vector<OfTiles> tiles_;
};

/// The signs in a closed mesh by all crossings of the grid's rows, which follow the mesh where it moves.
class KeptCrossings final : public SampleSigns {
 public:
  /// The bytes that they take, about.
  static double expected_bytes(const OrientedMesh& mesh, const Grid& grid) {
    const auto rows_of_tiles = static_cast<double>(tiles_along(grid.size.y) * tiles_along(grid.size.z));
    return RowCrossings::expected_bytes(mesh, grid) / 2 + rows_of_tiles * sizeof(std::vector<RowCrossing>);
  }
  /// As IntegerWinding. `bytes`: the most that they may take; the search takes about twice that besides. Where
  /// bytes() is more then, some are missing.
  KeptCrossings(const OrientedMesh& mesh, const Grid& grid, WindingRule rule, ProgressMeter& progress,
                std::int64_t bytes);

  /// What they take.
  std::int64_t bytes() const {
    return std::ssize(of_tiles_) * static_cast<std::int64_t>(sizeof(of_tiles_[0])) +
           count_ * static_cast<std::int64_t>(sizeof(RowCrossing));
  }
  /// Throws std::bad_alloc; then some of the crossings are missing.
  void follow(const ChangedCrossings& changed);

  void fill(InsideRows& rows, std::int64_t ty, std::int64_t tz) const override {
    rows.fill_between(of_tiles_[static_cast<std::size_t>(ty + tiles_y_ * tz)], rule_);
  }

 private:
  std::int64_t tiles_y_;
  WindingRule rule_;
  std::vector<std::vector<RowCrossing>> of_tiles_;
  std::int64_t count_ = 0;  // of all crossings
};

template <class Use>
void ChangedCrossings::each_changed(const Use& use) const {
  const std::int64_t tiles_y = tiles_along(size_.y);
  for (const OfTiles& tiles : tiles_) {
    const auto number = static_cast<std::int64_t>(tiles.number);
    auto gone = tiles.gone.begin(), come = tiles.come.begin();
    std::int32_t change = 0;
    int row = 0;
    std::int64_t since = 0;  // the sample from which on the change holds
    const auto tell = [&](std::int64_t end) {
      if (change != 0 && since < end)
        use(kTileSide * (number % tiles_y) + row % kTileSide, kTileSide * (number / tiles_y) + row / kTileSide, since,
            end);
      since = end;
    };
    while (gone != tiles.gone.end() || come != tiles.come.end()) {
      const bool goes = come == tiles.come.end() || (gone != tiles.gone.end() && *gone < *come);
      const RowCrossing& next = goes ? *gone++ : *come++;
      if (next.row() != row) {
        tell(size_.x);
        row = next.row();
        change = 0;
        since = next.past();
      }
      tell(next.past());
      change += goes ? -next.step() : next.step();
    }
    tell(size_.x);
  }
}

}  // namespace standoff
