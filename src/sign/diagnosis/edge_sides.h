// SPDX-License-Identifier: Apache-2.0
// The sides at each edge that count: those of triangles that are used and are no segments.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "sign/diagnosis/mesh_edges.h"

namespace standoff {

/// Calls visit(sides) for each edge at which any are left. A triangle with two equal corners has an edge twice, in both
/// directions: it cancels itself out, and would make a nonmanifold edge of a manifold one. `use` is OrientedMesh::use.
template <class Visit>
void for_each_edge(const MeshEdges& edges, std::span<const std::int8_t> use, const Visit& visit) {
  std::vector<EdgeUse> left;
  edges.for_each([&](std::span<const EdgeUse> sides) {
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
    if (!left.empty()) visit(std::span<const EdgeUse>(left));
  });
}

/// Whether an edge joins two triangles of one patch.
inline bool is_manifold(std::span<const EdgeUse> sides) { return sides.size() == 2; }

}  // namespace standoff
