// SPDX-License-Identifier: Apache-2.0
// The polygons of dual contouring: around each crossed edge of the grid, the vertices of its four cells.
#pragma once

#include <array>
#include <cstdint>

#include "standoff/mesh.h"
#include "surface/dual_cells.h"

namespace standoff {

struct DualPolygon {
  int size = 0;
  std::array<std::uint32_t, 8> vertices{};  ///< facing outwards

  void add(std::uint32_t vertex) { vertices[static_cast<std::size_t>(size++)] = vertex; }
  /// More than the four cells' vertices.
  bool has_more() const { return size > 4; }
};

/// How a polygon is cut.
enum class Cut : std::uint8_t {
  first,   ///< a quad, from its first to its third vertex
  second,  ///< a quad, from its second to its fourth vertex
  fan,     ///< around a vertex on the edge of the grid
};

class DualPolygons {
 public:
  /// The polygons of a block. `first_face`: by block, the number of the first vertex on its doubled faces; all of them
  /// outlive this.
  DualPolygons(const Blocks& blocks, const DualCells& cells, const Block& block,
               const std::vector<std::uint32_t>& first_face)
      : cells_(&cells), blocks_(&blocks), beside_(blocks.beside(block, -1)), first_face_(&first_face) {}

  /// The polygon around an edge; `outwards_up`: its lower end is inside.
  DualPolygon around(int axis, int x, int y, int z, bool outwards_up) const;

 private:
  CellOf cell(int x, int y, int z) const;

  const DualCells* cells_;
  const Blocks* blocks_;
  std::array<const Block*, 8> beside_;
  const std::vector<std::uint32_t>* first_face_;
};

/// Cuts a quad so that it stays among the four cells' tetrahedra at the edge, which no other polygon enters
/// ("Intersection- free contouring on an octree grid", Ju and Udeshi 2006): surfaces of cells with one loop then never
/// intersect themselves. `corner`: its vertices relative to the lower end of the edge, in spacings, in the order of the
/// polygon, with the edge's axis last.
Cut cut_of(const std::array<Vec3, 4>& corner);

}  // namespace standoff
