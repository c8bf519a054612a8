// SPDX-License-Identifier: Apache-2.0
// Which samples of a field are inside: one bit each, tile by tile.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/progress.h"
#include "standoff/field.h"

namespace standoff {

/// The bits of a tile: bit x + 8 y of word z. Set: inside.
using TileBits = std::array<std::uint64_t, 8>;

/// Samples below the level are inside; a sample of exactly the level is outside, and so is all that is beyond the grid.
class InsideBits {
 public:
  /// Requires |level| < field.thickness(). Runs on the threads of the calling TBB arena. Throws Error{input} if a value
  /// is not a number, and Error{interrupted}. The field outlives this.
  InsideBits(const DistanceField& field, double level, ProgressMeter& progress);

  /// The bytes that it takes.
  static std::size_t bytes_for(const DistanceField& field);

  const DistanceField& field() const { return *field_; }
  const Size3& tiles() const { return tiles_; }

  /// The bits of a tile; one beyond the grid has none.
  TileBits of(std::int64_t tx, std::int64_t ty, std::int64_t tz) const;

  static constexpr std::uint8_t kHasOutside = 1, kHasInside = 2;
  /// For each tile of a row what it has, tiles().x of them. A row beyond the grid has outside alone.
  const std::uint8_t* kinds_of_row(std::int64_t ty, std::int64_t tz) const;

 private:
  bool is_tile(std::int64_t tx, std::int64_t ty, std::int64_t tz) const {
    return tx >= 0 && ty >= 0 && tz >= 0 && tx < tiles_.x && ty < tiles_.y && tz < tiles_.z;
  }
  TileBits samples_of_grid(std::int64_t tx, std::int64_t ty, std::int64_t tz) const;

  const DistanceField* field_;
  Size3 tiles_;
  std::vector<TileBits> bits_;       // by slot
  std::vector<std::uint8_t> kinds_;  // by tile of the grid
  std::vector<std::uint8_t> outside_;
};

}  // namespace standoff
