// SPDX-License-Identifier: Apache-2.0
// How the corners, edges and faces of a cell of 8 samples are numbered.
#pragma once

#include <array>
#include <cstdint>

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

}  // namespace standoff
