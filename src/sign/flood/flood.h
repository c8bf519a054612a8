// SPDX-License-Identifier: Apache-2.0
// The signs in any mesh by a flood: a point is outside if a path from far away reaches it without passing through a
// triangle.
#pragma once

#include <array>
#include <vector>

#include "sign/flood/grid_edges.h"
#include "sign/signs.h"

namespace standoff {

/// A path of grid edges, none of which crosses a triangle, connects the samples outside with samples around the mesh's
/// box; all others are inside. The orientation of the triangles does not matter. The paths may leave the grid: where
/// the mesh does not end within the grid, the flood begins beyond it (TileLattice::around).
///
/// Gaps narrower than the grid's smallest spacing count as walls: a path keeps half a spacing from the mesh's rims,
/// which are the edges with an odd number of triangles. Samples so near to rims that no path leads there are decided
/// afterwards, by the samples around them (Settling). A mesh without rims has no gaps.
class Flood final : public SampleSigns {
 public:
  /// Requires a valid mesh and grid. Runs on the threads of the calling TBB arena. Takes 2.5 bits for each tile, and
  /// 256 bytes for each tile with a crossed edge; if the mesh has rims, also the memory of rim_edges_of(), and 4 KiB
  /// for each tile with a rim. Throws Error{interrupted}.
  Flood(MeshView mesh, const Grid& grid, ProgressMeter& progress);

  void fill(InsideRows& rows, std::int64_t ty, std::int64_t tz) const override;

  /// The number of samples of the grid inside.
  std::int64_t inside_samples() const { return inside_samples_; }
  /// Whether the flood came everywhere although the mesh crosses edges: through gaps, or because the mesh encloses no
  /// sample.
  bool leaks() const { return inside_samples_ == 0 && edges_.tiles().count() > 0; }

 private:
  using Sample = std::array<std::int64_t, 3>;  // of the lattice
  class Settling;

  void flood(ProgressMeter& progress);
  void enter(std::size_t tile, const TileBits& samples, std::vector<std::size_t>& next);
  TileBits apart(const GridEdges& edges, std::size_t tile) const;
  TileBits reached(std::size_t tile) const;
  TileBits inside_of(const Size3& size, const std::array<std::int64_t, 3>& tile) const;  // of the grid
  std::int64_t count_inside(const Size3& size) const;

  TileLattice lattice_;
  GridEdges edges_;                // no path takes these
  std::vector<TileBits> parts_;    // the samples reached, of each tile with such edges
  std::vector<bool> whole_tiles_;  // whether each of the other tiles was reached
  std::int64_t inside_samples_ = 0;
};

}  // namespace standoff
