// SPDX-License-Identifier: Apache-2.0
// What of a field can change when some triangles of its mesh move: tiles that they reach or enclose, in windows,
// and the triangles that each window needs.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/progress.h"
#include "standoff/grid.h"
#include "standoff/mesh.h"

namespace standoff {

/// Two meshes that differ in some triangles alone.
struct MeshChange {
  MeshView before, after;
  std::vector<std::uint32_t> triangles;  ///< ascending; those that only one mesh has are among them

  bool is_in(const MeshView& mesh, std::uint32_t triangle) const { return triangle < mesh.triangles.size(); }
  /// Those that one of the meshes has.
  std::span<const std::uint32_t> in(const MeshView& mesh) const {
    return {triangles.begin(), std::ranges::lower_bound(triangles, mesh.triangles.size())};
  }
};

/// What of the listed triangles, and of those that only one mesh has, really differs. Throws Error{usage} for triangles
/// that no mesh has; Error{input} if one is not valid.
MeshChange change_of(MeshView before, MeshView after, std::span<const std::uint32_t> listed);

/// What the place of a point beside samples may be off by, rounded several times, with a wide margin. World units.
double rounding_of_places(const Grid& grid);

/// The tile of a grid that a coordinate is in, by a product and not by a division. Callers allow for its rounding
/// (rounding_of_places).
class TileFinder {
 public:
  /// Tiles low to high - 1.
  struct Range {
    Size3 low, high;
  };

  explicit TileFinder(const Grid& grid);
  /// The nearest tile, where the coordinate is beside the grid.
  std::int64_t at(double coordinate, std::size_t axis) const {
    return static_cast<std::int64_t>(std::clamp((coordinate - corner_[axis]) * per_tile_[axis], 0.0, last_[axis]));
  }
  /// The tiles with samples in a box, and a few more.
  Range around(const Box& box) const;

 private:
  Box bounds_;
  Vec3 corner_, per_tile_, last_;
  Vec3 inset_;  // from a tile's last sample almost to the next tile's first one
};

/// Of cell (x, y, z) of a box, x fastest.
inline std::size_t cell_index(const Size3& size, std::int64_t x, std::int64_t y, std::int64_t z) {
  return static_cast<std::size_t>(x + size.x * (y + size.y * z));
}

/// The tiles of a grid, some of them dirty, and the bricks that these are in. One byte a tile (a slot has four), and
/// one a brick of eight tiles.
class DirtyTiles {
 public:
  /// Requires a valid grid.
  explicit DirtyTiles(const Grid& grid);

  const Grid& grid() const { return grid_; }
  const TileFinder& finder() const { return finder_; }
  /// The tiles with samples begin to end - 1 of row (j, k).
  void mark_row(std::int64_t j, std::int64_t k, std::int64_t begin, std::int64_t end);
  /// Those with samples within `reach` of a changed triangle's box, before or after.
  void mark_reached(const MeshChange& change, double reach);

  bool is_dirty(const Size3& tile) const { return tiles_.at(tile) != 0; }
  /// Whether some of the tiles low to high - 1 is.
  bool any_dirty(const Size3& low, const Size3& high) const { return tiles_.any(low, high); }
  /// Whether some of the tiles with samples in the box is, or of a few more.
  bool any_near(const Box& box) const;
  /// A byte for each tile of a window, x fastest: 1 where it is dirty.
  std::vector<std::uint8_t> marks_of(const Grid& window) const;
  /// How many are dirty.
  std::int64_t count() const { return tiles_.count(); }
  /// How many bricks have dirty tiles, and how many there are.
  std::int64_t bricks() const { return bricks_.count(); }
  std::int64_t all_bricks() const { return std::ssize(bricks_.marks); }
  /// Windows of all bricks with dirty tiles and of no others. They do not overlap.
  std::vector<Grid> windows() const;

 private:
  // A byte for each cell of a box, x fastest.
  struct Marks {
    Size3 size;
    std::vector<std::uint8_t> marks;

    explicit Marks(const Size3& cells) : size(cells), marks(static_cast<std::size_t>(cells.count())) {}
    std::size_t index(std::int64_t x, std::int64_t y, std::int64_t z) const { return cell_index(size, x, y, z); }
    std::uint8_t at(const Size3& cell) const { return marks[index(cell.x, cell.y, cell.z)]; }
    void set(const Size3& low, const Size3& high, std::uint8_t mark);
    bool all(const Size3& low, const Size3& high) const { return !has(low, high, 0); }
    bool any(const Size3& low, const Size3& high) const { return has(low, high, 1); }
    bool has(const Size3& low, const Size3& high, std::uint8_t mark) const;
    std::int64_t count() const { return std::ranges::count(marks, std::uint8_t{1}); }
  };

  void mark_tiles(const TileFinder::Range& tiles);

  Grid grid_;
  TileFinder finder_;
  Marks tiles_, bricks_;
};

/// The triangles that a window needs, ascending; a few more may be among them.
struct WindowTriangles {
  std::vector<std::uint32_t> near;     ///< within the reach of samples of dirty tiles
  std::vector<std::uint32_t> crossed;  ///< by rows of the window, or by rays from there to smaller x
};

/// Finds them for all windows, those of dirty.windows(), in one pass over the mesh.
/// `with_crossed`: whether those are asked for. Runs on the threads of the calling TBB arena. Requires a valid mesh.
/// Throws Error{interrupted}.
std::vector<WindowTriangles> triangles_of(MeshView mesh, const DirtyTiles& dirty, std::span<const Grid> windows,
                                          double reach, bool with_crossed, ProgressMeter& progress);

}  // namespace standoff
