// SPDX-License-Identifier: Apache-2.0
// All ways in which a surface can pass through a cell of 8 samples (docs/iso.md, "Cells").
//
// A corner is inside or outside. Each edge with one end inside has one vertex. On a face with two such edges they are
// joined by a segment. On a face with four, the inside corners lie across from each other, and the face is ambiguous:
// either they are joined across the face, or each is cut off by a segment of its own. With the answers for all
// ambiguous faces, the segments form closed loops, and each loop is the boundary of one piece of the surface.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "surface/cell_shape.h"

namespace standoff {

struct CellCase {
  static constexpr int kMostLoops = 4;
  static constexpr int kMostTriangles = 12;
  static constexpr std::uint8_t kCentre = kCellEdges;  ///< in `triangles`: the centre vertex

  int loop_count = 0;
  std::array<std::uint8_t, kMostLoops> loop_size{};
  std::array<std::uint8_t, kCellEdges> loop_edges{};  ///< loop after loop; seen from outside, anticlockwise
  std::array<std::uint8_t, kCellEdges> loop_of{};     ///< of an edge with a vertex
  /// The loop that no triangulation will do for (cell_cases.cpp), or -1: it becomes triangles around a vertex in its
  /// centre. No cell has two of them.
  int centre_loop = -1;
  int triangle_count = 0;
  std::array<std::array<std::uint8_t, 3>, kMostTriangles> triangles{};  ///< facing outwards; of edges or the centre

  std::span<const std::uint8_t> loop(int n) const {
    std::size_t first = 0;
    for (int m = 0; m < n; ++m) first += loop_size[static_cast<std::size_t>(m)];
    return std::span(loop_edges).subspan(first, loop_size[static_cast<std::size_t>(n)]);
  }
};

class CellCases {
 public:
  /// The one table, made at its first use.
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
  /// Of a cell without ambiguous faces.
  const CellCase& find(std::uint32_t inside) const { return cases_[first_[inside]]; }

 private:
  CellCases();

  std::array<std::uint8_t, 256> ambiguous_{};
  std::array<std::uint16_t, 256> first_{};
  std::vector<CellCase> cases_;
};

/// Whether the inside corners of an ambiguous face are joined: whether the bilinear interpolation is inside at its
/// saddle, where the asymptotes of its hyperbolas cross ("The asymptotic decider", Nielson and Hamann 1991). Arguments
/// are differences from the iso value: the two inside corners, which lie across from each other, and the two others.
/// Products of two floats are exact in double, and a change of order changes nothing: so both cells of the face get the
/// same answer. A saddle of exactly the iso value is outside, as a sample is; so is what is not a number, 0 * infinity.
inline bool is_joined(float inside_a, float inside_b, float outside_a, float outside_b) {
  return static_cast<double>(inside_a) * inside_b > static_cast<double>(outside_a) * outside_b;
}

}  // namespace standoff
