// SPDX-License-Identifier: Apache-2.0
// The vertices and polygons of dual contouring: a vertex for each loop of each cell; if two loops meet twice, a vertex
// on each of their two segments; and around each crossed edge of the grid, the polygon of its four cells' vertices.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/progress.h"
#include "standoff/mesh.h"
#include "surface/blocks.h"
#include "surface/cells.h"

namespace standoff {

/// A cell of a block, from 0 to 7 along each axis.
struct CellOf {
  const Block* block;
  int x, y, z;

  int bit() const { return x + 8 * y; }
  std::uint16_t number() const { return static_cast<std::uint16_t>(x + 8 * (y + 8 * z)); }
};

/// A cell with several loops, or with an ambiguous face.
struct SpecialCell {
  std::uint16_t cell;        ///< its number in the block
  std::uint16_t first_loop;  ///< the number of its second loop among all loops of the block that are not first ones
  const CellCase* found;
  std::uint32_t ambiguous;  ///< its ambiguous faces
};

/// A face whose two segments join the same two loops. Both segments would have the same dual edge, which would have
/// four triangles: so the surface gets a vertex on each segment.
struct DoubledFace {
  std::uint16_t cell;  ///< the number of the cell below the face
  std::uint8_t axis;   ///< the face is perpendicular to it
};

class DualCells {
 public:
  /// Numbers the loops' vertices, from `first_vertex` on. Runs on the threads of the calling TBB arena. Throws
  /// Error{limit}, Error{interrupted}.
  DualCells(Blocks& blocks, const UniformTiles& uniform, double level, std::uint64_t first_vertex,
            ProgressMeter& progress);

  std::size_t memory_bytes() const;
  /// The number after the last loop's vertex.
  std::uint64_t end() const { return end_; }
  std::int64_t ambiguous_faces() const { return ambiguous_faces_; }
  /// The entry of a special cell; nullptr for a cell with one loop and no ambiguous faces.
  const SpecialCell* special(const CellOf& cell) const;
  /// The vertex of a loop of the cell; `special`: the result of special().
  std::uint32_t vertex_of_loop(const CellOf& cell, const SpecialCell* special, int loop) const;

  std::span<const DoubledFace> doubled(const Block& block) const { return doubled_[blocks_->number_of(block)]; }
  /// The number, among the doubled faces of the lower cell's block, of the face above that cell along an axis; or -1.
  int find_doubled(const CellOf& lower, int axis) const;

 private:
  void find_doubled_faces(ProgressMeter& progress);

  const Blocks* blocks_;
  std::vector<std::array<std::uint64_t, 8>> is_special_;  // by block and layer
  std::vector<std::vector<SpecialCell>> special_;
  std::vector<std::vector<DoubledFace>> doubled_;
  std::uint64_t end_ = 0;
  std::int64_t ambiguous_faces_ = 0;
};

/// The edge at the other end of an edge's segment, in a face of a cell of this case.
int segment_end(const CellCase& found, int edge, int face);
/// The lowest edge of a face.
int first_edge_of(int face);

struct DualPolygon {
  int size = 0;
  std::array<std::uint32_t, 8> vertices{};  ///< facing outwards

  void add(std::uint32_t vertex) { vertices[static_cast<std::size_t>(size++)] = vertex; }
  /// Whether it has more than the four cells' vertices.
  bool has_more() const { return size > 4; }
};

/// The cut of a polygon into triangles.
enum class Cut : std::uint8_t {
  first,   ///< a quad, from its first to its third vertex
  second,  ///< a quad, from its second to its fourth vertex
  fan,     ///< around a vertex on the edge of the grid
};

class DualPolygons {
 public:
  /// The polygons of a block. `first_face`: by block, the number of the first vertex on its doubled faces. All
  /// arguments outlive this.
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
/// ("Intersection-free contouring on an octree grid", Ju and Udeshi 2006): surfaces of cells with one loop then never
/// intersect themselves. `corner`: its vertices relative to the lower end of the edge, in spacings, in the order of the
/// polygon, with the edge's axis last.
Cut cut_of(const std::array<Vec3, 4>& corner);

}  // namespace standoff
