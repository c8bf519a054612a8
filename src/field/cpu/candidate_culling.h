// SPDX-License-Identifier: Apache-2.0
// Thick bands and full fields: which triangles each brick, tile and cell has to look at (docs/tiles.md).
//
//   triangles in packs of 16, packs of packs (clusters.h)
//       |  the largest packs
//       v
//   +-------------+     +------+     +---+   +--+
//   |             | --> |      | --> |   |-->|  |--> triangles of a tile, or of a cell where a tile is crowded
//   |  the grid   |     | half |     |   |   +--+
//   |             |     +------+     +---+   tile
//   +-------------+                  brick
//
// A cell's list is made out of its parent's in three steps.
//   1. Cull. An entry (a triangle or a pack, by its box) is dropped where it cannot hold the point nearest to any
//      sample of the cell: it is beyond the thickness, or for each sample some reference, a point of the surface, is
//      nearer.
//   2. Open. Packs longer than half the cell are replaced by what they hold, culled alike, until none is left. Where
//      the list is full the rest stays closed, and the tile opens it part by part.
//   3. Points. Near each of the 3x3x3 points that divide the cell into halves a point of the surface is found, by
//      following the nearest boxes down to a triangle. Those at its eight corners are a half's references.
#pragma once

#include <cstdint>
#include <vector>

#include "field/backend.h"
#include "field/cpu/box_list.h"
#include "field/cpu/cells.h"
#include "field/cpu/clusters.h"
#include "field/cpu/kernels.h"

namespace standoff::cpu {

/// The points that divide a cell into halves, and a point of the surface near each.
struct SurfacePoints {
  float at[kLatticeSide][kLatticeSide][kLatticeSide][3];  // z, y, x, coordinate
};

/// The references of a half of `cell`.
References references_of(const SurfacePoints& points, const Cell& cell, const Cell& half);

/// What candidates are culled for: the samples of a cell, and points of the surface near its corners.
struct CellTarget {
  CullCell samples;
  References near;
};

/// Packs longer than this are opened on the way to a cell, grid units: half its longest side. A longer pack is a poor
/// stand-in for its triangles there; a shorter one is opened further down, where most of it has been culled.
float opened_length(const CullCell& samples);

/// A cell and its list.
struct CellCandidates {
  explicit CellCandidates(std::int64_t capacity) : list(capacity) {}

  Cell cell{};  ///< none yet: its side is zero
  BoxList list;
  SurfacePoints points;  ///< where the list is not empty
};

/// What one thread uses again and again.
struct CandidateLists {
  CandidateLists(int level_count, std::int64_t capacity);
  static std::int64_t bytes(int level_count, std::int64_t capacity);

  /// The whole grid first, a brick last. A level holds the cell that was entered last, so that the bricks of one cell
  /// share its list.
  std::vector<CellCandidates> levels;
  BoxList tile, cell;
  BoxList part;  ///< of the candidates of a tile or cell, where they are too many for one list
  std::vector<PackContents> packs;
  std::vector<std::uint32_t> triangles;
};

/// Many threads may ask, each with lists of its own.
class CandidateCulling {
 public:
  /// `order` of the triangles: triangle_order.h.
  CandidateCulling(const Job& job, const BlockLattice& lattice, const Kernels& kernels,
                   std::vector<std::uint32_t> order);
  /// Bytes that it and the lists of so many threads may hold, whatever the triangles.
  static std::int64_t bytes(std::int64_t triangles, const BlockLattice& lattice, int threads);

  /// For cells within cells, so many.
  CandidateLists make_lists(int level_count) const;
  CellTarget target(const Cell& cell, const References& near) const;
  /// The mesh index of an entry that is a triangle.
  std::uint32_t triangle(std::uint32_t entry) const { return clusters_.triangle(entry); }
  const Clusters& clusters() const { return clusters_; }
  /// The largest packs, which hold all others.
  const BoxArrays& roots() const { return roots_.arrays(); }

  /// The candidates of a cell of a level, 0 being the whole grid. Requires that its parent was entered before.
  const CellCandidates& enter(int level, const Cell& cell, const References& near, CandidateLists& lists) const;

  /// What of the parent's list may be nearest to a sample of the target, with no pack longer than `largest` where there
  /// is room for what they hold. Returns whether there was.
  bool narrow(const BoxArrays& parent, const CellTarget& target, float largest, BoxList& result,
              std::vector<PackContents>& packs) const;
  /// Puts in the place of packs longer than `largest` what of them may be nearest; returns as above.
  bool open_packs(const CellTarget& target, float largest, BoxList& list, std::vector<PackContents>& packs) const;
  /// Takes some candidates out of a list, opening all packs, into lists.part: triangles alone. False at the end, where
  /// the list is empty and no more are left.
  bool next_part(const CellTarget& target, BoxList& list, CandidateLists& lists) const;

  /// Whether a tile has so many candidates, small ones, that its cells had better choose theirs by boxes.
  bool is_crowded(const BoxList& list, const CellTarget& tile) const;
  /// Requires a list with an entry.
  SurfacePoints points_of(const CullCell& samples, const BoxArrays& list) const;
  /// A cell of a brick as the kernels see it; refers to `boxes`, all of triangles.
  CrowdedCell crowded_cell(const Brick& brick, const Cell& cell, const BoxArrays& boxes) const;

 private:
  bool take_large(std::int64_t first, float largest, BoxList& list, std::vector<PackContents>& packs) const;
  std::uint32_t near_triangle(std::uint32_t entry, const float (&at)[3]) const;
  void set_triangle(std::uint32_t triangle, int lane, TriangleLanes& lanes) const;

  const Job& job_;
  const BlockLattice& lattice_;
  const Kernels& kernels_;
  Clusters clusters_;
  BoxList roots_;
};

}  // namespace standoff::cpu
