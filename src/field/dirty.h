// SPDX-License-Identifier: Apache-2.0
// What of a field can change when some triangles of its mesh move: tiles that they reach or enclose, in windows,
// and the triangles that each window needs.
#pragma once

#include <algorithm>
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

/// The tiles of a grid, some of them dirty, and the bricks that these are in. One byte each, a quarter of what the
/// field's slots take, and an eighth of that.
class DirtyTiles {
 public:
  /// Requires a valid grid.
  explicit DirtyTiles(const Grid& grid);

  const Grid& grid() const { return grid_; }
  /// The tiles with samples in the box.
  void mark(const Box& box);
  /// The tiles with samples begin to end - 1 of row (j, k).
  void mark_row(std::int64_t j, std::int64_t k, std::int64_t begin, std::int64_t end);
  /// Those with samples within `reach` of a changed triangle's box, before or after.
  void mark_reached(const MeshChange& change, double reach);

  bool is_dirty(const Size3& tile) const { return tiles_.at(tile) != 0; }
  /// Whether some of the tiles low to high - 1 is.
  bool any_dirty(const Size3& low, const Size3& high) const { return tiles_.any(low, high); }
  /// How many are dirty.
  std::int64_t count() const { return tiles_.count(); }
  /// How many bricks have dirty tiles, and how many there are.
  std::int64_t bricks() const { return bricks_.count(); }
  std::int64_t all_bricks() const { return std::ssize(bricks_.marks); }
  /// Windows of all bricks with dirty tiles and of no others. They do not overlap.
  std::vector<Grid> windows() const;
  /// Calls use(box) for boxes that hold all samples of dirty tiles of a window: one of the window, or of each brick or
  /// tile.
  template <class Use>
  void each_box(const Grid& window, const Use& use) const {
    const Cells all = cells_of(window);
    if (tiles_.all(all.low, all.high)) return use(window.bounds());
    for (Size3 at = all.low; at.z < all.high.z; at.z += 2)
      for (at.y = all.low.y; at.y < all.high.y; at.y += 2)
        for (at.x = all.low.x; at.x < all.high.x; at.x += 2) each_box_of_brick(at, use);
  }

 private:
  // Cells of a box: tiles or bricks low to high - 1.
  struct Cells {
    Size3 low, high;
  };
  // A byte for each cell of a box, x fastest.
  struct Marks {
    Size3 size;
    std::vector<std::uint8_t> marks;

    explicit Marks(const Size3& cells) : size(cells), marks(static_cast<std::size_t>(cells.count())) {}
    std::size_t index(std::int64_t x, std::int64_t y, std::int64_t z) const {
      return static_cast<std::size_t>(x + size.x * (y + size.y * z));
    }
    std::uint8_t at(const Size3& cell) const { return marks[index(cell.x, cell.y, cell.z)]; }
    void set(const Size3& low, const Size3& high, std::uint8_t mark);
    bool all(const Size3& low, const Size3& high) const { return !has(low, high, 0); }
    bool any(const Size3& low, const Size3& high) const { return has(low, high, 1); }
    bool has(const Size3& low, const Size3& high, std::uint8_t mark) const;
    std::int64_t count() const { return std::ranges::count(marks, std::uint8_t{1}); }
  };

  void mark_tiles(const Size3& low, const Size3& high);
  Cells cells_of(const Grid& window) const;
  Box samples_of(const Size3& low, const Size3& high) const;
  template <class Use>
  void each_box_of_brick(const Size3& low, const Use& use) const {
    const Size3 high{std::min(low.x + 2, tiles_.size.x), std::min(low.y + 2, tiles_.size.y),
                     std::min(low.z + 2, tiles_.size.z)};
    if (tiles_.all(low, high)) return use(samples_of(low, high));
    for (Size3 at = low; at.z < high.z; ++at.z)
      for (at.y = low.y; at.y < high.y; ++at.y)
        for (at.x = low.x; at.x < high.x; ++at.x)
          if (is_dirty(at)) use(samples_of(at, {at.x + 1, at.y + 1, at.z + 1}));
  }

  Grid grid_;
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
