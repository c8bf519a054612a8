// SPDX-License-Identifier: Apache-2.0
// Which tiles of a grid the triangles of a mesh reach: what a sparse field may store, before it is computed.
#pragma once

#include <cstdint>
#include <vector>

#include "core/tile_count.h"
#include "geometry/predicates.h"
#include "geometry/triangle_box.h"
#include "standoff/grid.h"

namespace standoff {

/// Blocks of samples, of the same side along each axis, from `begin` to before `end`.
struct BlocksOfSamples {
  Size3 begin, end;

  /// Those that hold some of the samples. Requires a range that is not empty.
  BlocksOfSamples(const SampleRange& samples, std::int64_t side);
  double count() const;
};

/// A bit for each tile. In grids of more than 2^27 tiles, and where the reach is more than 16 samples, a bit stands for
/// several, all of which count as reached.
class ReachedTiles {
 public:
  /// `reach`: the distance within which a triangle reaches samples, world units. The grid must outlive this.
  ReachedTiles(const Grid& grid, double reach);

  /// Marks the tiles that a triangle may reach. `samples`: those in its box grown by the reach, at least one. Threads
  /// may call it at the same time.
  void mark(const Corners& corners, const SampleRange& samples);

  /// An upper bound of the number of tiles that are marked.
  double count() const;

 private:
  Size3 blocks() const;
  void set(std::int64_t block);

  const Grid& grid_;
  double reach_;
  std::int64_t side_ = kTileSide;  // of a block
  Size3 count_;
  std::vector<std::uint64_t> bits_;
};

}  // namespace standoff
