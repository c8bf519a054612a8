// SPDX-License-Identifier: Apache-2.0
// How near the edges of a lattice pass by the rims of a mesh, which are where its surface ends: a path through a gap
// has to pass by the rims beside the gap.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/progress.h"
#include "sign/flood/tile_bits.h"
#include "sign/flood/tile_lattice.h"
#include "sign/flood/tile_set.h"
#include "standoff/mesh.h"

namespace standoff {

using RimEdge = std::array<Vec3, 2>;

/// The edges of a mesh that have an odd number of triangles, by position, also without those whose height is below a
/// millionth of the mesh's longest side: such a needle closes no gap and has none beside it. Takes 200 bytes per
/// triangle while it runs, on the threads of the calling TBB arena. Throws Error{interrupted}.
std::vector<RimEdge> rim_edges_of(MeshView mesh, ProgressMeter& progress);

/// Of the edges of a lattice, from each sample to the next one along an axis, those with a point nearer to a rim than
/// `reach`. Distances are in steps of reach / 65535, rounded down. Takes 3 KiB for each tile with such an edge.
class RimDistances {
 public:
  static constexpr std::uint16_t kFar = 65535;  ///< not within reach

  /// Runs on the threads of the calling TBB arena. Throws Error{interrupted}.
  RimDistances(std::span<const RimEdge> rims, const TileLattice& lattice, double reach, ProgressMeter& progress);

  /// The tiles that have edges within reach, and perhaps some around them.
  const TileSet& tiles() const { return tiles_; }
  /// Of the edge from a sample of a tile, x + 8 y + 64 z, along an axis.
  std::uint16_t of(std::size_t tile, std::size_t axis, std::size_t sample) const {
    return tiles_.has(tile) ? steps_[tiles_.number(tile)][axis][sample] : kFar;
  }
  /// The samples of a tile from which the edge along each axis is less far from a rim than that.
  TileEdges nearer_than(std::uint16_t steps, std::size_t tile) const;

 private:
  using Steps = std::array<std::array<std::uint16_t, 512>, 3>;

  TileSet tiles_;
  std::vector<Steps> steps_;  // by number in tiles_
};

}  // namespace standoff
