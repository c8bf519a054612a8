// SPDX-License-Identifier: Apache-2.0
// Thick bands and full fields: which triangles each brick, tile and cell has to look at (docs/tiles.md).
//
//   triangles in nodes of 16, nodes of nodes (bvh/bvh.h)
//       |  the largest nodes
//       v
//   +-------------+     +------+     +---+   +--+
//   |             | --> |      | --> |   |-->|  |--> triangles of a tile, or of a cell where a tile is crowded
//   |  the grid   |     | half |     |   |   +--+
//   |             |     +------+     +---+   tile
//   +-------------+                  brick
//
// A cell's list is made out of its parent's in three steps.
//   1. Cull. An entry (a triangle or a node, by its box) is dropped where it cannot hold the point nearest to any
//      sample of the cell: it is beyond the thickness, or for each sample some reference, a point of the surface, is
//      nearer.
//   2. Open. Nodes longer than half the cell are replaced by what they hold, culled alike, until none is left. Where
//      the list is full the rest stays closed, and the tile opens it part by part.
//   3. Points. Near each of the 3x3x3 points that divide the cell into halves a point of the surface is found, by
//      following the nearest boxes down to a triangle. Those at its eight corners are a half's references.
#pragma once

#include <tbb/blocked_range.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <vector>

#include "bvh/bvh.h"
#include "field/backend.h"
#include "field/cpu/kernels.h"

namespace standoff::cpu {

// The cells that candidates are handed down through: the grid, its halves, and theirs.

/// Samples [low, high) per axis of the grid, 2^n of them on a side before the grid cuts it.
struct Cell {
  std::int64_t low[3], high[3];
  std::int64_t side;

  friend bool operator==(const Cell&, const Cell&) = default;
};

/// The cell that holds all samples.
inline Cell whole_grid(const BlockLattice& lattice) {
  Cell whole{{0, 0, 0}, {lattice.size[0], lattice.size[1], lattice.size[2]}, kBrickSide};
  while (whole.side < *std::max_element(lattice.size, lattice.size + 3)) whole.side *= 2;
  return whole;
}

/// How many cells lie within one another from the grid to a brick, both counted.
inline int levels_of(const BlockLattice& lattice) {
  int levels = 1;
  for (std::int64_t side = whole_grid(lattice).side; side > kBrickSide; side /= 2) ++levels;
  return levels;
}

/// The eight or fewer halves of a cell; returns how many.
inline int halves(const Cell& cell, Cell (&parts)[8]) {
  int count = 0;
  const std::int64_t half = cell.side / 2;
  for (int n = 0; n < 8; ++n) {
    Cell& part = parts[count];
    part.side = half;
    bool some = true;
    for (int axis = 0; axis < 3; ++axis) {
      part.low[axis] = cell.low[axis] + ((n >> axis & 1) != 0 ? half : 0);
      part.high[axis] = std::min(part.low[axis] + half, cell.high[axis]);
      some = some && part.low[axis] < part.high[axis];
    }
    count += some;
  }
  return count;
}

/// Which of a brick's tiles a half of it is.
inline int tile_in(const Cell& brick, const Cell& tile) {
  int number = 0;
  for (int axis = 0; axis < 3; ++axis) number += tile.low[axis] > brick.low[axis] ? 1 << axis : 0;
  return number;
}

/// Bricks [low, high) per axis: what one thread does, until another wants half of it (TBB's Range). It is cut where
/// cells are, across its longest side, so that what a thread does lies together.
class BrickRange {
 public:
  BrickRange(const BlockLattice& lattice, const BrickLayers& layers)
      : low_{0, 0, layers.begin}, high_{lattice.bricks[0], lattice.bricks[1], layers.end} {}
  BrickRange(BrickRange& other, tbb::split) : BrickRange(other) {
    const int axis = other.longest();
    std::int64_t step = 1;
    while ((other.low_[axis] / (2 * step) + 1) * (2 * step) < other.high_[axis]) step *= 2;
    low_[axis] = other.high_[axis] = (other.low_[axis] / step + 1) * step;
  }

  bool empty() const { return false; }
  bool is_divisible() const { return high_[longest()] - low_[longest()] > 1; }

  /// How many bricks of the cell are in the range.
  std::int64_t bricks_of(const Cell& cell) const {
    std::int64_t count = 1;
    for (int axis = 0; axis < 3; ++axis) {
      const std::int64_t first = std::max(low_[axis], cell.low[axis] / kBrickSide);
      const std::int64_t last = std::min(high_[axis] - 1, (cell.high[axis] - 1) / kBrickSide);
      count *= std::max<std::int64_t>(0, last - first + 1);
    }
    return count;
  }

 private:
  int longest() const {
    int best = 0;
    for (int axis = 1; axis < 3; ++axis)
      if (high_[axis] - low_[axis] >= high_[best] - low_[best]) best = axis;
    return best;
  }

  std::int64_t low_[3], high_[3];
};

// A list of boxes, of a length that is known beforehand.

/// There is always room for a whole register past the last entry, which the kernels may touch.
class BoxList {
 public:
  explicit BoxList(std::int64_t capacity)
      : sides_(std::make_unique_for_overwrite<float[]>(static_cast<std::size_t>(kSides * (capacity + kLanes)))),
        entries_(std::make_unique_for_overwrite<std::uint32_t[]>(static_cast<std::size_t>(capacity + kLanes))) {
    for (int axis = 0; axis < 3; ++axis) {
      arrays_.low[axis] = sides_.get() + axis * (capacity + kLanes);
      arrays_.high[axis] = sides_.get() + (3 + axis) * (capacity + kLanes);
    }
    arrays_.entry = entries_.get();
  }
  static constexpr std::int64_t bytes(std::int64_t capacity) {
    return (kSides * static_cast<std::int64_t>(sizeof(float)) + static_cast<std::int64_t>(sizeof(std::uint32_t))) *
           (capacity + kLanes);
  }

  std::int64_t size() const { return arrays_.count; }
  std::uint32_t entry(std::int64_t n) const { return arrays_.entry[n]; }
  float longest_side(std::int64_t n) const {
    return std::max({arrays_.high[0][n] - arrays_.low[0][n], arrays_.high[1][n] - arrays_.low[1][n],
                     arrays_.high[2][n] - arrays_.low[2][n]});
  }
  const BoxArrays& arrays() const { return arrays_; }
  /// For kernels that add to the list.
  BoxArrays& arrays() { return arrays_; }

  void clear() { arrays_.count = 0; }
  void shrink(std::int64_t count) { arrays_.count = count; }
  void add(std::uint32_t entry, const Boxes16& boxes, int lane) {
    const std::int64_t at = arrays_.count++;
    for (int axis = 0; axis < 3; ++axis) {
      arrays_.low[axis][at] = boxes.low[axis][lane];
      arrays_.high[axis][at] = boxes.high[axis][lane];
    }
    arrays_.entry[at] = entry;
  }
  /// Adds entry n of another list.
  void add(const BoxList& other, std::int64_t n) { copy(other.arrays_, n, arrays_.count++); }
  /// Moves entry n to position `to`, not behind it.
  void move(std::int64_t n, std::int64_t to) { copy(arrays_, n, to); }

 private:
  static constexpr std::int64_t kSides = 6;

  void copy(const BoxArrays& from, std::int64_t n, std::int64_t to) {
    for (int axis = 0; axis < 3; ++axis) {
      arrays_.low[axis][to] = from.low[axis][n];
      arrays_.high[axis][to] = from.high[axis][n];
    }
    arrays_.entry[to] = from.entry[n];
  }

  BoxArrays arrays_{};
  std::unique_ptr<float[]> sides_;
  std::unique_ptr<std::uint32_t[]> entries_;
};

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

/// Boxes are kept in grid units relative to the centre of the grid.
BvhFrame frame_of(const BlockLattice& lattice);

/// Nodes longer than this are opened on the way to a cell, grid units: half its longest side. A longer node is a poor
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
  std::vector<BvhNode> nodes;
  std::vector<std::uint32_t> triangles;
};

/// Many threads may ask, each with lists of its own.
class CandidateCulling {
 public:
  /// `order` of the triangles: morton_order() or halving_order().
  CandidateCulling(const Job& job, const BlockLattice& lattice, const Kernels& kernels,
                   std::vector<std::uint32_t> order);
  /// Bytes that it and the lists of so many threads may hold, whatever the triangles.
  static std::int64_t bytes(std::int64_t triangles, const BlockLattice& lattice, int threads);
  /// Of that, its own, while they are made.
  static std::int64_t bvh_bytes(std::int64_t triangles, int threads);

  /// For cells within cells, so many.
  CandidateLists make_lists(int level_count) const;
  CellTarget target(const Cell& cell, const References& near) const;
  /// The mesh index of an entry that is a triangle.
  std::uint32_t triangle(std::uint32_t entry) const { return bvh_.order()[entry]; }
  const Bvh& bvh() const { return bvh_; }
  /// The largest nodes, which hold all others.
  const BoxArrays& roots() const { return roots_.arrays(); }

  /// The candidates of a cell of a level, 0 being the whole grid. Requires that its parent was entered before.
  const CellCandidates& enter(int level, const Cell& cell, const References& near, CandidateLists& lists) const;

  /// What of the parent's list may be nearest to a sample of the target, with no node longer than `largest` where there
  /// is room for what they hold. Returns whether there was.
  bool narrow(const BoxArrays& parent, const CellTarget& target, float largest, BoxList& result,
              std::vector<BvhNode>& nodes) const;
  /// Puts in the place of nodes longer than `largest` what of them may be nearest; returns as above.
  bool open_nodes(const CellTarget& target, float largest, BoxList& list, std::vector<BvhNode>& nodes) const;
  /// Takes some candidates out of a list, opening all nodes, into lists.part: triangles alone. False at the end, where
  /// the list is empty and no more are left.
  bool next_part(const CellTarget& target, BoxList& list, CandidateLists& lists) const;

  /// Whether a tile has so many candidates, small ones, that its cells had better choose theirs by boxes.
  bool is_crowded(const BoxList& list, const CellTarget& tile) const;
  /// Requires a list with an entry.
  SurfacePoints points_of(const CullCell& samples, const BoxArrays& list) const;
  /// A cell of a brick as the kernels see it; refers to `boxes`, all of triangles.
  CrowdedCell crowded_cell(const Brick& brick, const Cell& cell, const BoxArrays& boxes) const;

 private:
  bool take_large(std::int64_t first, float largest, BoxList& list, std::vector<BvhNode>& nodes) const;
  std::uint32_t near_triangle(std::uint32_t entry, const float (&at)[3]) const;
  void set_triangle(std::uint32_t triangle, int lane, TriangleLanes& lanes) const;

  const Job& job_;
  const BlockLattice& lattice_;
  const Kernels& kernels_;
  std::unique_ptr<float[][3]> centroids_;  // of the triangles by place, as exact as the boxes and in their frame
  Bvh bvh_;
  BoxList roots_;
};

}  // namespace standoff::cpu
