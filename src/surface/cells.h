// SPDX-License-Identifier: Apache-2.0
// The cells of a grid: the numbers of their corners, edges and faces, all cases of a surface in a cell of 8 samples
// (docs/surface_methods.md, "Cells"), and loops over the values, cells and edges of all blocks.
//
// A corner is inside or outside. Each edge with one end inside has one vertex. On a face with two such edges, a segment
// joins their vertices. On a face with four, the inside corners lie across from each other, and the face is ambiguous:
// either the corners are joined across the face, or a segment cuts off each of them. With the answers for all ambiguous
// faces, the segments form closed loops, and each loop is the boundary of a piece of the surface.
#pragma once

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/progress.h"
#include "standoff/field.h"
#include "surface/blocks.h"

namespace standoff {

// Corner n is at (n & 1, n >> 1 & 1, n >> 2 & 1). Edges 0-3 are parallel to x, 4-7 to y, 8-11 to z; among the four of
// an axis they are counted by their place along the two other axes, the lower axis first. Face 2 a + s is perpendicular
// to axis a, at s.

inline constexpr int kCellEdges = 12;
inline constexpr int kCellFaces = 6;

constexpr int edge_axis(int edge) { return edge / 4; }

/// The corner at the lower end of an edge. The other one is corner + (1 << axis).
constexpr int edge_corner(int edge) {
  const int axis = edge / 4, u = edge & 1, v = edge >> 1 & 1;
  const int first = axis == 0 ? 1 : 0, second = axis == 2 ? 1 : 2;  // the two other axes
  return u << first | v << second;
}

/// The edge at a corner, along an axis.
constexpr int edge_at(int corner, int axis) {
  const int first = axis == 0 ? 1 : 0, second = axis == 2 ? 1 : 2;
  return 4 * axis + (corner >> first & 1) + 2 * (corner >> second & 1);
}

/// The corners of a face, anticlockwise as seen from outside the cell.
constexpr std::array<int, 4> face_corners(int face) {
  const int axis = face / 2, side = face & 1;
  const int u = 1 << (axis + 1) % 3, v = 1 << (axis + 2) % 3, at = side << axis;
  if (side == 1) return {at, at | u, at | u | v, at | v};
  return {at, at | v, at | u | v, at | u};
}

/// The edge between two neighbouring corners.
constexpr int edge_between(int a, int b) {
  const int along = a ^ b;
  return edge_at(a & b, along == 1 ? 0 : along == 2 ? 1 : 2);
}

/// The two faces that an edge belongs to, one bit each.
constexpr std::uint32_t edge_faces(int edge) {
  const int axis = edge_axis(edge), corner = edge_corner(edge);
  std::uint32_t faces = 0;
  for (int other = 0; other < 3; ++other)
    if (other != axis) faces |= 1u << (2 * other + (corner >> other & 1));
  return faces;
}

struct CellCase {
  static constexpr int kMostLoops = 4;
  static constexpr int kMostTriangles = 12;
  static constexpr std::uint8_t kCentre = kCellEdges;  ///< in `triangles`: the centre vertex

  int loop_count = 0;
  std::array<std::uint8_t, kMostLoops> loop_size{};
  std::array<std::uint8_t, kCellEdges> loop_edges{};  ///< loop after loop; seen from outside, anticlockwise
  std::array<std::uint8_t, kCellEdges> loop_of{};     ///< the loop of an edge with a vertex
  /// The loop without an allowed triangulation (cells.cpp), or -1: it becomes triangles around a vertex in its centre.
  /// No cell has two of them.
  int centre_loop = -1;
  int triangle_count = 0;
  std::array<std::array<std::uint8_t, 3>, kMostTriangles> triangles{};  ///< facing outwards; edges or kCentre

  std::span<const std::uint8_t> loop(int n) const {
    std::size_t first = 0;
    for (int m = 0; m < n; ++m) first += loop_size[static_cast<std::size_t>(m)];
    return std::span(loop_edges).subspan(first, loop_size[static_cast<std::size_t>(n)]);
  }
};

class CellCases {
 public:
  /// The table, made at its first use.
  static const CellCases& table();

  /// The ambiguous faces of a cell whose corners in `inside` are inside, one bit each.
  std::uint32_t ambiguous(std::uint32_t inside) const { return ambiguous_[inside]; }
  /// `joined`: the ambiguous faces whose inside corners are joined, one bit each.
  const CellCase& find(std::uint32_t inside, std::uint32_t joined) const {
    std::uint32_t packed = 0;
    if (joined != 0) {
      std::uint32_t bit = 1;
      for (std::uint32_t faces = ambiguous_[inside]; faces != 0; faces &= faces - 1, bit <<= 1)
        if ((joined & faces & (0 - faces)) != 0) packed |= bit;
    }
    return cases_[first_[inside] + packed];
  }
  /// The case of a cell without ambiguous faces.
  const CellCase& find(std::uint32_t inside) const { return cases_[first_[inside]]; }

 private:
  CellCases();

  std::array<std::uint8_t, 256> ambiguous_{};
  std::array<std::uint16_t, 256> first_{};
  std::vector<CellCase> cases_;
};

/// Whether the inside corners of an ambiguous face are joined, that is, whether the bilinear interpolation is inside at
/// its saddle, where the asymptotes of its hyperbolas cross ("The asymptotic decider", Nielson and Hamann 1991).
/// Arguments are differences from the iso value: of the two inside corners, which lie across from each other, and of
/// the two others. Products of two floats are exact in double, so their order changes nothing, and both cells of the
/// face get the same answer. A saddle of exactly the iso value is outside, as a sample is; so is NaN, from 0 *
/// infinity.
inline bool is_joined(float inside_a, float inside_b, float outside_a, float outside_b) {
  return static_cast<double>(inside_a) * inside_b > static_cast<double>(outside_a) * outside_b;
}

/// The values of tiles that are not stored.
class UniformTiles {
 public:
  explicit UniformTiles(double thickness) {
    outside_.fill(static_cast<float>(thickness));
    inside_.fill(static_cast<float>(-thickness));
    beyond_.fill(std::numeric_limits<float>::infinity());
  }
  const float* of(std::int32_t slot) const { return slot == DistanceField::kInside ? inside_.data() : outside_.data(); }
  const float* beyond_grid() const { return beyond_.data(); }

 private:
  using Tile = std::array<float, DistanceField::kTileSamples>;
  Tile outside_, inside_, beyond_;
};

/// A block and all blocks around it.
class Neighbourhood {
 public:
  /// Both arguments outlive this.
  Neighbourhood(const DistanceField& field, const UniformTiles& uniform, const std::array<std::int32_t, 3>& at)
      : size_(field.grid().size), first_{8 * std::int64_t{at[0]}, 8 * std::int64_t{at[1]}, 8 * std::int64_t{at[2]}} {
    const Size3 tiles = field.tile_count();
    const auto slots = field.slots();
    const float* const values = field.tile_values().data();
    std::size_t n = 0;
    for (std::int64_t z = at[2] - 1; z <= at[2] + 1; ++z)
      for (std::int64_t y = at[1] - 1; y <= at[1] + 1; ++y)
        for (std::int64_t x = at[0] - 1; x <= at[0] + 1; ++x, ++n) {
          const bool is_tile = x >= 0 && y >= 0 && z >= 0 && x < tiles.x && y < tiles.y && z < tiles.z;
          if (!is_tile || slots.empty()) {
            tile_[n] = uniform.beyond_grid();
            continue;
          }
          const std::int32_t slot = slots[static_cast<std::size_t>(x + tiles.x * (y + tiles.y * z))];
          tile_[n] = slot < 0 ? uniform.of(slot) : values + std::int64_t{DistanceField::kTileSamples} * slot;
        }
    at_border_ = first_.x + 16 > size_.x || first_.y + 16 > size_.y || first_.z + 16 > size_.z;
  }

  /// The value of a sample, counted from the block's first one: from -8 to 15 along each axis. Beyond the grid it is
  /// +infinity.
  float value(int x, int y, int z) const {
    if (at_border_ && !is_sample(x, y, z)) return std::numeric_limits<float>::infinity();
    const int tile = ((x + 8) >> 3) + 3 * (((y + 8) >> 3) + 3 * ((z + 8) >> 3));
    return tile_[static_cast<std::size_t>(tile)][(x & 7) + 8 * (y & 7) + 64 * (z & 7)];
  }
  /// Whether an edge of the block may have an end beyond the grid.
  bool leaves_grid() const { return at_border_ || first_.x < 0 || first_.y < 0 || first_.z < 0; }
  bool is_sample(int x, int y, int z) const {
    const std::int64_t i = first_.x + x, j = first_.y + y, k = first_.z + z;
    return i >= 0 && j >= 0 && k >= 0 && i < size_.x && j < size_.y && k < size_.z;
  }

 private:
  Size3 size_, first_;
  std::array<const float*, 27> tile_;
  bool at_border_ = false;
};

/// A cell of a block, by its lowest sample: from 0 to 7 along each axis.
struct CellAt {
  int x, y, z;
};

/// The ambiguous faces of a cell whose inside corners are joined, one bit each.
inline std::uint32_t joined_faces(const Neighbourhood& values, double level, CellAt cell, std::uint32_t inside,
                                  std::uint32_t ambiguous) {
  std::uint32_t joined = 0;
  for_each_bit(ambiguous, [&](int face) {
    const auto corners = face_corners(face);
    std::array<float, 4> v;
    for (std::size_t n = 0; n < 4; ++n) {
      const int c = corners[n];
      v[n] = static_cast<float>(values.value(cell.x + (c & 1), cell.y + (c >> 1 & 1), cell.z + (c >> 2)) - level);
    }
    const bool first = (inside >> corners[0] & 1) != 0;
    if (first ? is_joined(v[0], v[2], v[1], v[3]) : is_joined(v[1], v[3], v[0], v[2])) joined |= 1u << face;
  });
  return joined;
}

/// Calls use(cell, case, ambiguous faces) for each cell of the block that the surface passes through, x fastest.
template <class Use>
void for_each_cell(const Block& block, const CornerBits& corners, const Neighbourhood& values, double level,
                   const Use& use) {
  const CellCases& cases = CellCases::table();
  for (int z = 0; z < 8; ++z)
    for_each_bit(block.cells[static_cast<std::size_t>(z)], [&](int bit) {
      const CellAt cell{bit & 7, bit >> 3, z};
      const std::uint32_t inside = corners.corners(bit, z);
      const std::uint32_t ambiguous = cases.ambiguous(inside);
      if (ambiguous == 0) return use(cell, cases.find(inside), ambiguous);
      use(cell, cases.find(inside, joined_faces(values, level, cell, inside, ambiguous)), ambiguous);
    });
}

/// Calls use(axis, x, y, z) for each crossed edge of the block, in the order of their numbers.
template <class Use>
void for_each_edge(const Block& block, const Use& use) {
  for (int axis = 0; axis < 3; ++axis)
    for (int z = 0; z < 8; ++z)
      for_each_bit(block.edges[static_cast<std::size_t>(axis)][static_cast<std::size_t>(z)],
                   [&](int bit) { use(axis, bit & 7, bit >> 3, z); });
}

/// Blocks by their numbers, from `begin` to before `end`.
struct BlockRange {
  std::size_t begin, end;
};
/// Calls use(number, block, corners, values) for each block of the range. Runs on the threads of the calling TBB arena.
/// Throws Error{interrupted}.
template <class Use>
void for_each_block(const Blocks& blocks, const BlockRange& some, const UniformTiles& uniform, ProgressMeter& progress,
                    const Use& use) {
  constexpr std::size_t kAtOnce = 16;  // blocks of a task: some tens of microseconds
  const auto all = blocks.all();
  tbb::parallel_for(tbb::blocked_range<std::size_t>(some.begin, some.end, kAtOnce), [&](const auto& range) {
    progress.advance(static_cast<std::int64_t>(range.size()));
    for (std::size_t n = range.begin(); n < range.end(); ++n)
      use(n, all[n], blocks.corner_bits(all[n]), Neighbourhood(blocks.field(), uniform, all[n].at));
  });
}
/// The same for all blocks.
template <class Use>
void for_each_block(const Blocks& blocks, const UniformTiles& uniform, ProgressMeter& progress, const Use& use) {
  for_each_block(blocks, {0, blocks.all().size()}, uniform, progress, use);
}

}  // namespace standoff
