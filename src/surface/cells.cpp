// SPDX-License-Identifier: Apache-2.0
// Makes the table of all cases of a cell: its loops, and their triangles.
#include "surface/cells.h"

#include <bit>
#include <limits>

namespace standoff {
namespace {

constexpr int kNoCycle = -1;

bool has(std::uint32_t set, int n) { return (set >> n & 1) != 0; }

bool is_ambiguous(std::uint32_t inside, int face) {
  const auto c = face_corners(face);
  return has(inside, c[0]) == has(inside, c[2]) && has(inside, c[1]) == has(inside, c[3]) &&
         has(inside, c[0]) != has(inside, c[1]);
}

// next[e]: the edge that the segment from edge e leads to. Anticlockwise around a face, a segment leads from where the
// walk enters the inside to where it leaves it. An edge is entered in one of its faces and left in the other one, so
// that each has one successor and one predecessor.
std::array<int, kCellEdges> successors(std::uint32_t inside, std::uint32_t joined) {
  std::array<int, kCellEdges> next{};
  next.fill(kNoCycle);
  for (int face = 0; face < kCellFaces; ++face) {
    const auto c = face_corners(face);
    const auto corner = [&](int n) { return c[static_cast<std::size_t>(n % 4)]; };
    for (int n = 0; n < 4; ++n) {
      if (has(inside, corner(n)) || !has(inside, corner(n + 1))) continue;
      int last = n + 1;  // the last corner that is inside
      while (has(inside, corner(last + 1))) ++last;
      if (has(joined, face)) last += 2;  // across the face
      next[static_cast<std::size_t>(edge_between(corner(n), corner(n + 1)))] =
          edge_between(corner(last), corner(last + 1));
    }
  }
  return next;
}

// The place of an edge's middle, in half cells.
std::array<int, 3> middle(int edge) {
  const int corner = edge_corner(edge);
  std::array<int, 3> at{2 * (corner & 1), 2 * (corner >> 1 & 1), 2 * (corner >> 2 & 1)};
  at[static_cast<std::size_t>(edge_axis(edge))] = 1;
  return at;
}

// Cuts a loop into triangles. A diagonal whose ends are on one face of the cell would lie in that face, where the
// neighbouring cell may have the same one: an edge of four triangles. Such diagonals are not taken. Of all
// triangulations without them that with the shortest diagonals wins; some loops have none.
class LoopTriangles {
 public:
  explicit LoopTriangles(std::span<const std::uint8_t> loop) : loop_(loop) {
    const std::size_t n = loop.size();
    for (std::size_t length = 2; length < n; ++length)
      for (std::size_t i = 0; i + length < n; ++i) {
        const std::size_t j = i + length;
        for (std::size_t k = i + 1; k < j; ++k) {
          const int cost = side(i, k) + side(k, j) + best_[i][k] + best_[k][j];
          if (k == i + 1 || cost < best_[i][j]) {
            best_[i][j] = cost;
            split_[i][j] = k;
          }
        }
      }
  }
  bool exist() const { return best_[0][loop_.size() - 1] < kForbidden; }
  void add_to(CellCase& to) const { add(0, loop_.size() - 1, to); }

 private:
  static constexpr int kForbidden = 1000;

  // The cost of a triangle's side: nothing if it is the loop's.
  int side(std::size_t i, std::size_t j) const {
    if (j == i + 1) return 0;
    const int a = loop_[i], b = loop_[j];
    if ((edge_faces(a) & edge_faces(b)) != 0) return kForbidden;
    int length_sq = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const int step = middle(a)[axis] - middle(b)[axis];
      length_sq += step * step;
    }
    return length_sq;
  }
  void add(std::size_t i, std::size_t j, CellCase& to) const {
    if (j == i + 1) return;
    const std::size_t k = split_[i][j];
    add(i, k, to);
    add(k, j, to);
    to.triangles[static_cast<std::size_t>(to.triangle_count++)] = {loop_[i], loop_[k], loop_[j]};
  }

  std::span<const std::uint8_t> loop_;
  std::array<std::array<int, kCellEdges>, kCellEdges> best_{};
  std::array<std::array<std::size_t, kCellEdges>, kCellEdges> split_{};
};

void add_triangles(int loop_number, CellCase& to) {
  const auto loop = to.loop(loop_number);
  const LoopTriangles triangles(loop);
  if (triangles.exist()) return triangles.add_to(to);
  to.centre_loop = loop_number;
  for (std::size_t n = 0; n < loop.size(); ++n)
    to.triangles[static_cast<std::size_t>(to.triangle_count++)] = {loop[n], loop[(n + 1) % loop.size()],
                                                                   CellCase::kCentre};
}

CellCase make_case(std::uint32_t inside, std::uint32_t joined) {
  const auto next = successors(inside, joined);
  CellCase made;
  made.loop_of.fill(std::numeric_limits<std::uint8_t>::max());
  std::size_t end = 0;
  for (int first = 0; first < kCellEdges; ++first) {
    if (next[static_cast<std::size_t>(first)] == kNoCycle || made.loop_of[static_cast<std::size_t>(first)] != 255)
      continue;
    const int loop = made.loop_count++;
    for (int edge = first; made.loop_of[static_cast<std::size_t>(edge)] == 255;
         edge = next[static_cast<std::size_t>(edge)]) {
      made.loop_of[static_cast<std::size_t>(edge)] = static_cast<std::uint8_t>(loop);
      made.loop_edges[end++] = static_cast<std::uint8_t>(edge);
      ++made.loop_size[static_cast<std::size_t>(loop)];
    }
  }
  for (int loop = 0; loop < made.loop_count; ++loop) add_triangles(loop, made);
  return made;
}

}  // namespace

CellCases::CellCases() {
  for (std::uint32_t inside = 0; inside < 256; ++inside) {
    for (int face = 0; face < kCellFaces; ++face)
      if (is_ambiguous(inside, face)) ambiguous_[inside] = static_cast<std::uint8_t>(ambiguous_[inside] | 1u << face);
    first_[inside] = static_cast<std::uint16_t>(cases_.size());
    const std::uint32_t faces = ambiguous_[inside];
    for (std::uint32_t packed = 0; packed < 1u << std::popcount(faces); ++packed) {
      std::uint32_t joined = 0, bit = 0;
      for (std::uint32_t left = faces; left != 0; left &= left - 1, ++bit)
        if (has(packed, static_cast<int>(bit))) joined |= left & (0 - left);
      cases_.push_back(make_case(inside, joined));
    }
  }
}

const CellCases& CellCases::table() {
  static const CellCases cases;
  return cases;
}

}  // namespace standoff
