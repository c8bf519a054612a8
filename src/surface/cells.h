// SPDX-License-Identifier: Apache-2.0
// The cells of a block, one after the other.
#pragma once

#include <cstdint>

#include "surface/blocks.h"
#include "surface/cell_cases.h"
#include "surface/neighbourhood.h"

namespace standoff {

/// The cells that a cell's lowest sample is counted by.
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

}  // namespace standoff
