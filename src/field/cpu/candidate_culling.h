// SPDX-License-Identifier: Apache-2.0
// Thick bands and full fields: the candidates of each brick, tile and cell, its triangles that may be nearest to one of
// its samples (docs/tiles.md).
//
//   triangles in nodes of 16, nodes of nodes (bvh/bvh.h)
//       |  the root nodes
//       v
//   +-------------+     +------+     +---+   +--+
//   |             | --> |      | --> |   |-->|  |--> triangles of a tile, or of a cell where a tile is crowded
//   |  the grid   |     | half |     |   |   +--+
//   |             |     +------+     +---+   tile
//   +-------------+                  brick
//
// A cell's list is made from its parent's list in three steps.
//   1. Cull. An entry, which is a triangle or a node, is dropped if its box cannot hold the point nearest to any sample
//      of the cell: the box is beyond the thickness, or for each sample some reference, a point of the surface, is
//      nearer.
//   2. Open. Nodes longer than half the cell are replaced by their children, which are culled the same way, until none
//      is left. If the list is full, the rest stays closed, and the tile opens it part by part.
//   3. Find references. Near each of the 3x3x3 points that divide the cell into halves, a point of the surface is found
//      by following the nearest boxes down to a triangle. The points at a half's eight corners are its references.
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

/// A cell of the hierarchy: the grid, a half of it, a half of that, and so on. It holds samples [low, high) per axis,
/// `side` = 2^n of them unless the grid ends before.
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

/// The number of levels from the grid to a brick, both included.
inline int levels_of(const BlockLattice& lattice) {
  int levels = 1;
  for (std::int64_t side = whole_grid(lattice).side; side > kBrickSide; side /= 2) ++levels;
  return levels;
}

/// Writes the halves of a cell, along all three axes; returns their number, at most eight.
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

/// The number of a tile in its brick.
inline int tile_in(const Cell& brick, const Cell& tile) {
  int number = 0;
  for (int axis = 0; axis < 3; ++axis) number += tile.low[axis] > brick.low[axis] ? 1 << axis : 0;
  return number;
}

/// Bricks [low, high) per axis: the work of a thread, until another thread takes half of it (TBB's Range). It is cut
/// between cells, across its longest side, so that the work of a thread stays compact.
class BrickRange {
 public:
  /// The bricks of a window of the lattice's grid, which begins at a brick.
  BrickRange(const Grid& grid, const Grid& window) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low_[axis] = (window.first[axis] - grid.first[axis]) / kBrickSide;
      high_[axis] = low_[axis] + (window.size[axis] + kBrickSide - 1) / kBrickSide;
    }
  }
  BrickRange(BrickRange& other, tbb::split) : BrickRange(other) {
    const int axis = other.longest();
    std::int64_t step = 1;
    while ((other.low_[axis] / (2 * step) + 1) * (2 * step) < other.high_[axis]) step *= 2;
    low_[axis] = other.high_[axis] = (other.low_[axis] / step + 1) * step;
  }

  bool empty() const { return false; }
  bool is_divisible() const { return high_[longest()] - low_[longest()] > 1; }

  /// The number of the cell's bricks in the range.
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

/// A list of boxes of fixed capacity. The kernels may write a whole register past the last entry: there is room for it.
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
  /// How far entry n is from the samples, along the axis on which it is farthest; 0 if it is among them.
  float gap(std::int64_t n, const CullCell& samples) const {
    float most = 0;
    for (int axis = 0; axis < 3; ++axis)
      most = std::max({most, arrays_.low[axis][n] - samples.center[axis] - samples.half[axis],
                       samples.center[axis] - arrays_.high[axis][n] - samples.half[axis]});
    return most;
  }
  const BoxArrays& arrays() const { return arrays_; }
  /// The memory of the list, for kernels that add to it.
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

/// The references of `half`, which is a half of `cell`.
References references_of(const SurfacePoints& points, const Cell& cell, const Cell& half);

/// The target of a culling step: the samples of a cell, and points of the surface near its corners.
struct CellTarget {
  CullCell samples;
  References near;
};

/// The frame of the boxes: grid units relative to the centre of the grid.
BvhFrame frame_of(const BlockLattice& lattice);

/// Nodes longer than this are opened for a cell, grid units: half its longest side. A longer node bounds its triangles
/// poorly there; a shorter one is opened further down, where most of its triangles are culled.
float opened_length(const CullCell& samples);

/// A cell and its list.
struct CellCandidates {
  explicit CellCandidates(std::int64_t capacity) : list(capacity) {}

  Cell cell{};  ///< side 0: no cell yet
  BoxList list;
  SurfacePoints points;  ///< valid if the list is not empty
};

/// The memory of a thread.
struct CandidateLists {
  CandidateLists(int level_count, std::int64_t capacity);
  static std::int64_t bytes(int level_count, std::int64_t capacity);

  /// One per level, the whole grid first and a brick last. A level holds the cell that was entered last, so that the
  /// bricks of a cell share its list.
  std::vector<CellCandidates> levels;
  BoxList tile, cell;
  BoxList part;  ///< some candidates of a tile or cell that has too many for one list
  std::vector<BvhNode> nodes;
  std::vector<std::uint32_t> triangles;
  std::vector<std::uint32_t> in_entries;  ///< a triangle of each entry of a crowded cell's list
};

/// Makes the lists of cells. Many threads may use it at once, each with its own lists.
class CandidateCulling {
 public:
  /// `order`: the order of triangles in the BVH, by morton_order() or halving_order().
  CandidateCulling(const Job& job, const BlockLattice& lattice, const Kernels& kernels,
                   std::vector<std::uint32_t> order);
  /// An upper bound of the bytes of this and the lists of all threads.
  static std::int64_t bytes(std::int64_t triangles, const BlockLattice& lattice, int threads);
  /// The share of the BVH in it, while it is built.
  static std::int64_t bvh_bytes(std::int64_t triangles, int threads);

  /// Makes the lists of a thread, for this number of levels.
  CandidateLists make_lists(int level_count) const;
  CellTarget target(const Cell& cell, const References& near) const;
  /// The triangle of an entry that is no node.
  std::uint32_t triangle(std::uint32_t entry) const { return bvh_.order()[entry]; }
  const Bvh& bvh() const { return bvh_; }
  /// The root nodes.
  const BoxArrays& roots() const { return roots_.arrays(); }

  /// The candidates of a cell of a level; level 0 is the whole grid. Requires that its parent was entered before.
  const CellCandidates& enter(int level, const Cell& cell, const References& near, CandidateLists& lists) const;

  /// Writes to `result` the entries of `parent` that may be nearest to a sample of the target. Opens nodes longer than
  /// `largest` while there is room for their children; returns whether there was room for all.
  bool narrow(const BoxArrays& parent, const CellTarget& target, float largest, BoxList& result,
              std::vector<BvhNode>& nodes) const;
  /// Replaces nodes longer than `largest` by their children that may be nearest; returns the same as narrow().
  bool open_nodes(const CellTarget& target, float largest, BoxList& list, std::vector<BvhNode>& nodes) const;
  /// Moves some candidates from `list` to lists.part, and opens all nodes among them, so that only triangles are left.
  /// False if the list is empty.
  bool next_part(const CellTarget& target, BoxList& list, CandidateLists& lists) const;

  /// Whether a tile has so many small candidates, and is so near to them, that its cells had better cull them by boxes.
  bool is_crowded(const BoxList& list, const CellTarget& tile) const;
  /// Requires a list with an entry.
  SurfacePoints points_of(const CullCell& samples, const BoxArrays& list) const;
  /// The number of nodes whose longest side is at most `longest`.
  std::int64_t nodes_below(float longest, const BoxList& list) const;
  /// A triangle of each entry of a list, in memory of `lists`.
  const std::uint32_t* first_triangles(const BoxList& list, CandidateLists& lists) const;
  /// A cell of a brick as the kernels see it. Keeps a reference to `boxes`.
  CrowdedCell crowded_cell(const Brick& brick, const Cell& cell, const BoxArrays& boxes) const;

 private:
  bool take_large(std::int64_t first, float largest, BoxList& list, std::vector<BvhNode>& nodes) const;
  std::uint32_t near_triangle(std::uint32_t entry, const float (&at)[3]) const;
  void set_triangle(std::uint32_t triangle, int lane, TriangleLanes& lanes) const;

  const Job& job_;
  const BlockLattice& lattice_;
  const Kernels& kernels_;
  HugePageArray<float[3]> centroids_;  // by entry, in the frame of the boxes and as exact as they are
  Bvh bvh_;
  BoxList roots_;
};

}  // namespace standoff::cpu
