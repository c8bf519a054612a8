// SPDX-License-Identifier: Apache-2.0
// The signs in any mesh by a flood: a point is outside if a path from far away reaches it without passing through a
// triangle.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/progress.h"
#include "sign/flood/lattice.h"
#include "sign/flood/tile_bits.h"
#include "sign/signs.h"
#include "standoff/mesh.h"

namespace standoff {

/// What a flood found, of the tiles of a lattice.
struct FloodSides {
  TileSet tiles;                ///< those with edges that no path takes
  std::vector<TileBits> parts;  ///< the samples of each of them that it reached, by number in `tiles`
  std::vector<bool> whole;      ///< whether it reached each of the other tiles

  TileBits reached(std::size_t tile) const {
    if (tiles.has(tile)) return parts[tiles.number(tile)];
    return whole[tile] ? kAllBits : TileBits{};
  }
};

/// A path of grid edges, none of which crosses a triangle, connects the samples outside with samples around the mesh's
/// box; all others are inside. The orientation of the triangles does not matter. The paths may leave the grid: where
/// the mesh does not end within the grid, the flood begins beyond it (TileLattice::around).
///
/// Gaps narrower than the grid's smallest spacing count as walls: a path keeps half a spacing from the mesh's rims,
/// which are the edges with an odd number of triangles. Samples so near to rims that no path leads there are decided
/// afterwards, by the samples around them (Settling). A mesh without rims has no gaps.
class Flood final : public SampleSigns {
 public:
  /// Requires a valid mesh and grid. Runs on the threads of the calling TBB arena. Takes 2.5 bits for each tile, and 64
  /// bytes for each tile with a crossed edge; while it is made, 256 for each of these, and if the mesh has rims also
  /// the memory of rim_edges_of(), and 4 KiB for each tile with a rim. Throws Error{interrupted}.
  Flood(MeshView mesh, const Grid& grid, ProgressMeter& progress);
  /// The same by the sides that a flood found before. Throws Error{input} where they are of another mesh or grid.
  Flood(MeshView mesh, const Grid& grid, std::shared_ptr<const FloodSides> sides);

  void fill(InsideRows& rows, std::int64_t ty, std::int64_t tz) const override;

  const std::shared_ptr<const FloodSides>& sides() const { return sides_; }
  /// The number of samples of the grid inside. Goes through all its tiles.
  std::int64_t inside_samples() const;
  /// Whether the flood came everywhere although the mesh crosses edges: through gaps, or because the mesh encloses no
  /// sample. Goes through all tiles of the grid.
  bool leaks() const { return sides_->tiles.count() > 0 && inside_samples() == 0; }

 private:
  TileBits inside_of(const Size3& size, const std::array<std::int64_t, 3>& tile) const;  // of the grid

  Size3 size_;  // of the grid
  TileLattice lattice_;
  std::shared_ptr<const FloodSides> sides_;
};

}  // namespace standoff
