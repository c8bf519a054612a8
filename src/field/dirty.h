// SPDX-License-Identifier: Apache-2.0
// What of a field can change when some triangles of its mesh move: bricks that they reach or may enclose, in windows,
// and the triangles that each window needs.
#pragma once

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
};

/// What of the listed triangles, and of those that only one mesh has, really differs. Throws Error{usage} for triangles
/// that no mesh has; Error{input} if one is not valid.
MeshChange change_of(MeshView before, MeshView after, std::span<const std::uint32_t> listed);

/// What the place of a point beside samples may be off by, rounded several times, with a wide margin. World units.
double rounding_of_places(const Grid& grid);

/// The boxes around sets of changed triangles that share corners, by position, before or after. If both meshes are
/// closed, so is what a set adds to them and takes from them together: winding numbers are as before outside its box.
std::vector<Box> enclosing_boxes(const MeshChange& change);

/// The bricks of a grid, some of them dirty. One byte each, an eighth of what the field's slots take.
class DirtyBricks {
 public:
  /// Requires a valid grid.
  explicit DirtyBricks(const Grid& grid);

  /// The bricks with samples in the box.
  void mark(const Box& box);
  /// Those with samples within `reach` of a changed triangle's box, before or after.
  void mark_reached(const MeshChange& change, double reach);

  /// How many are dirty.
  std::int64_t count() const;
  std::int64_t all() const { return static_cast<std::int64_t>(marks_.size()); }
  /// Windows of all dirty bricks and of no others. They do not overlap.
  std::vector<Grid> windows() const;

 private:
  bool is_dirty(const Size3& low, const Size3& high) const;
  void set(const Size3& low, const Size3& high, std::uint8_t mark);

  Grid grid_;
  Size3 bricks_;
  std::vector<std::uint8_t> marks_;
};

/// The triangles that a window needs, ascending; a few more may be among them.
struct WindowTriangles {
  std::vector<std::uint32_t> near;     ///< of samples within the reach
  std::vector<std::uint32_t> crossed;  ///< by rows of the window, or by rays from there to smaller x
};

/// Finds them for all windows in one pass over the mesh. `windows`: of whole bricks of the grid, which do not overlap.
/// `with_crossed`: whether those are asked for. Runs on the threads of the calling TBB arena. Requires a valid mesh.
/// Throws Error{interrupted}.
std::vector<WindowTriangles> triangles_of(MeshView mesh, const Grid& grid, std::span<const Grid> windows, double reach,
                                          bool with_crossed, ProgressMeter& progress);

}  // namespace standoff
