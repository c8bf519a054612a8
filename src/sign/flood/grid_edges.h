// SPDX-License-Identifier: Apache-2.0
// The edges of a lattice, from each sample to the next one along x, y and z: which of them cross a mesh, so that a path
// from sample to sample passes through a surface; and their distances from the mesh's rims, where its surface ends, so
// that a path through a gap has to pass by the rims beside the gap.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/progress.h"
#include "sign/flood/lattice.h"
#include "sign/flood/tile_bits.h"
#include "standoff/mesh.h"

namespace standoff {

using RimEdge = std::array<Vec3, 2>;

/// The edges of a mesh that have an odd number of triangles, by position, and still have without triangles whose height
/// is below a millionth of the mesh's longest side: such a needle closes no gap and has none beside it. Takes 200 bytes
/// per triangle while it runs, on the threads of the calling TBB arena. Throws Error{interrupted}.
std::vector<RimEdge> rim_edges_of(MeshView mesh, ProgressMeter& progress);

/// The edges of a lattice with a point nearer to a rim than `reach`, with their distances, in steps of reach / 65535,
/// rounded down. Takes 3 KiB for each tile with such an edge.
class RimDistances {
 public:
  static constexpr std::uint16_t kFar = 65535;  ///< not within reach

  /// Runs on the threads of the calling TBB arena. Throws Error{interrupted}.
  RimDistances(std::span<const RimEdge> rims, const TileLattice& lattice, double reach, ProgressMeter& progress);

  /// The tiles that have edges within reach, and perhaps some around them.
  const TileSet& tiles() const { return tiles_; }
  /// The distance of the edge from a sample of a tile, x + 8 y + 64 z, along an axis.
  std::uint16_t of(std::size_t tile, std::size_t axis, std::size_t sample) const {
    return tiles_.has(tile) ? steps_[tiles_.number(tile)][axis][sample] : kFar;
  }
  /// For each axis the samples of a tile whose edge is nearer to a rim than this.
  TileEdges nearer_than(std::uint16_t steps, std::size_t tile) const;

 private:
  using Steps = std::array<std::array<std::uint16_t, 512>, 3>;

  TileSet tiles_;
  std::vector<Steps> steps_;  // by number in tiles_
};

/// The edges that no path takes. Crossings are exact (for_each_edge_hit). Takes 192 bytes for each tile with a crossed
/// edge, and while it is made 8 bytes for each crossing.
class GridEdges {
 public:
  /// No edge is crossed.
  explicit GridEdges(const TileLattice& lattice) : tiles_(lattice.tile_count()) {}
  /// The edges that cross a mesh, and the edges that are nearer to its rims than `steps`.
  GridEdges(const GridEdges& crossed, const RimDistances& rims, std::uint16_t steps, const TileLattice& lattice);
  /// Requires a valid mesh. Runs on the threads of the calling TBB arena. Throws Error{interrupted}.
  GridEdges(MeshView mesh, const TileLattice& lattice, ProgressMeter& progress);

  /// The tiles with crossed edges. An edge between two tiles belongs to the lower one.
  const TileSet& tiles() const { return tiles_; }
  /// Gives the set away.
  TileSet take_tiles() { return std::move(tiles_); }
  const TileEdges& of_tile(std::size_t tile) const { return tiles_.has(tile) ? edges_[tiles_.number(tile)] : kNoEdges; }

 private:
  TileSet tiles_;
  std::vector<TileEdges> edges_;  // by number in tiles_
};

/// Calls use(face, neighbour) for the tiles next to a tile.
template <class Use>
void for_each_neighbour(const TileLattice& lattice, std::size_t tile, const Use& use) {
  const std::array<std::int64_t, 3> at = lattice.tile_at(tile),
                                    tiles{lattice.tiles.x, lattice.tiles.y, lattice.tiles.z};
  for (const Face face : kFaces) {
    std::array<std::int64_t, 3> other = at;
    other[face.axis] += face.up ? 1 : -1;
    if (other[face.axis] < 0 || other[face.axis] == tiles[face.axis]) continue;
    use(face, lattice.index(other[0], other[1], other[2]));
  }
}

}  // namespace standoff
