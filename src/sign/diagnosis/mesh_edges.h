// SPDX-License-Identifier: Apache-2.0
// Which triangles meet at the edges of a mesh. Vertices count by position, so the mesh need not be welded.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "core/progress.h"
#include "sign/diagnosis/disjoint_sets.h"
#include "standoff/mesh.h"

namespace standoff {

/// One side of a triangle, along one of the mesh's edges.
struct HalfEdge {
  std::uint32_t low, high;  ///< its ends, numbers of positions, low < high
  std::uint32_t triangle;
  std::uint8_t corner;  ///< the side leads from this corner of the triangle to the next one
  bool forward;         ///< whether the triangle goes from low to high
};

class MeshEdges {
 public:
  /// Requires a valid mesh. Sides whose ends share a position are no edges. Runs on the threads of the calling TBB
  /// arena.
  explicit MeshEdges(MeshView mesh) {
    ProgressMeter nobody;
    find(mesh, nobody);
  }
  /// The progress can end it.
  MeshEdges(MeshView mesh, ProgressMeter& progress) { find(mesh, progress); }

  /// The number of distinct positions; they are numbered from 0.
  std::uint32_t positions() const { return static_cast<std::uint32_t>(first_.size() - 1); }
  /// The number of the position of a triangle's corner.
  std::uint32_t position(std::size_t triangle, int corner) const {
    return corners_[3 * triangle + static_cast<std::size_t>(corner)];
  }
  /// All half-edges, sorted by low, high, triangle: those of one edge lie together.
  std::span<const HalfEdge> half_edges() const { return half_edges_; }
  /// Calls use(span) for each edge, with all its half-edges.
  template <class Use>
  void for_each(const Use& use) const {
    for (auto next = half_edges_.begin(); next != half_edges_.end();) {
      const auto first = next;
      while (next != half_edges_.end() && next->low == first->low && next->high == first->high) ++next;
      use(std::span<const HalfEdge>(first, next));
    }
  }
  /// The connected components of the positions: triangles join their corners.
  DisjointSets connected_positions() const;

 private:
  void find(MeshView mesh, ProgressMeter& progress);

  std::vector<std::uint32_t> corners_;  // numbers of positions, three per triangle
  std::vector<std::size_t> first_;      // the first half-edge of each low end
  std::vector<HalfEdge> half_edges_;
};

/// Calls visit(sides) for each edge, with the half-edges of the triangles in use, unless none is left. A triangle with
/// two equal corners has an edge twice, in both directions. It is passed over, because it cancels itself and would make
/// a nonmanifold edge of a manifold one. `use` is OrientedMesh::use.
template <class Visit>
void for_each_edge(const MeshEdges& edges, std::span<const std::int8_t> use, const Visit& visit) {
  std::vector<HalfEdge> left;
  edges.for_each([&](std::span<const HalfEdge> sides) {
    const auto counts = [&](std::size_t n) {
      const std::uint32_t triangle = sides[n].triangle;
      return (use.empty() || use[triangle] != 0) && (n == 0 || sides[n - 1].triangle != triangle) &&
             (n + 1 == sides.size() || sides[n + 1].triangle != triangle);
    };
    std::size_t first = 0;
    while (first < sides.size() && counts(first)) ++first;
    if (first == sides.size()) return visit(sides);
    left.assign(sides.begin(), sides.begin() + static_cast<std::ptrdiff_t>(first));
    for (std::size_t n = first; n < sides.size(); ++n)
      if (counts(n)) left.push_back(sides[n]);
    if (!left.empty()) visit(std::span<const HalfEdge>(left));
  });
}

/// Whether an edge joins two triangles of one patch.
inline bool is_manifold(std::span<const HalfEdge> sides) { return sides.size() == 2; }

/// How often triangles in this orientation go along a half-edge from low to high (1), from high to low (-1), or not at
/// all (0). `use` is OrientedMesh::use.
inline std::int32_t direction_of(const HalfEdge& side, std::span<const std::int8_t> use) {
  const std::int32_t oriented = use.empty() ? 1 : use[side.triangle];
  return side.forward ? oriented : -oriented;
}

/// The sum of directions at an edge: 0 where they cancel, anything else on the boundary.
inline std::int32_t excess_of(std::span<const HalfEdge> sides, std::span<const std::int8_t> use) {
  std::int32_t excess = 0;
  for (const HalfEdge& side : sides) excess += direction_of(side, use);
  return excess;
}

}  // namespace standoff
