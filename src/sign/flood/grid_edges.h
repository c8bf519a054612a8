// SPDX-License-Identifier: Apache-2.0
// Which edges of a lattice, from each sample to the next one along x, y and z, cross a mesh: where a path from sample
// to sample passes through a surface.
#pragma once

#include <vector>

#include "core/progress.h"
#include "sign/flood/rim_distances.h"
#include "sign/flood/tile_bits.h"
#include "sign/flood/tile_lattice.h"
#include "sign/flood/tile_set.h"
#include "standoff/mesh.h"

namespace standoff {

/// Exact, as lattice_crossings.h says. Takes 192 bytes for each tile with a crossed edge, and while it is made 8 bytes
/// for each crossing.
class GridEdges {
 public:
  /// No edge is crossed.
  explicit GridEdges(const TileLattice& lattice) : tiles_(lattice.tile_count()) {}
  /// The edges that cross a mesh, and those that are nearer to its rims than so many steps.
  GridEdges(const GridEdges& crossed, const RimDistances& rims, std::uint16_t steps, const TileLattice& lattice);
  /// Requires a valid mesh. Runs on the threads of the calling TBB arena. Throws Error{interrupted}.
  GridEdges(MeshView mesh, const TileLattice& lattice, ProgressMeter& progress);

  /// The tiles with crossed edges. An edge between two tiles belongs to the lower one.
  const TileSet& tiles() const { return tiles_; }
  const TileEdges& of_tile(std::size_t tile) const { return tiles_.has(tile) ? edges_[tiles_.number(tile)] : kNoEdges; }

 private:
  TileSet tiles_;
  std::vector<TileEdges> edges_;  // by number in tiles_
};

}  // namespace standoff
