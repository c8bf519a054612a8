// SPDX-License-Identifier: Apache-2.0
#include "sign/diagnosis/boundary.h"

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "sign/diagnosis/disjoint_sets.h"

namespace standoff {
namespace {

// An edge by one of its sides: a soup has three per triangle, so they are small until their order is known.
struct Numbered {
  EdgeUse side;
  std::int32_t excess;
};

// The position of a side's end with the lower, or higher, number.
Vec3 end_of(const MeshView& mesh, const EdgeUse& side, bool low) {
  const int corner = low == side.forward ? side.corner : (side.corner + 1) % 3;
  return mesh.corner(side.triangle, corner);
}

BoundaryEdge placed(const MeshView& mesh, const Numbered& one) {
  return {end_of(mesh, one.side, one.excess > 0), end_of(mesh, one.side, one.excess < 0), std::abs(one.excess)};
}

std::vector<Numbered> edges_in_excess(const OrientedMesh& mesh, const MeshEdges& edges) {
  std::vector<Numbered> found;
  edges.for_each([&](std::span<const EdgeUse> sides) {
    std::int32_t excess = 0;
    for (const EdgeUse& side : sides) excess += side.forward ? mesh.use_of(side.triangle) : -mesh.use_of(side.triangle);
    if (excess != 0) found.push_back({sides.front(), excess});
  });
  return found;
}

Vec3 farthest_from(const Vec3& from, std::span<const BoundaryEdge> loop) {
  Vec3 farthest = from;
  for (const BoundaryEdge& edge : loop)
    for (const Vec3& p : {edge.from, edge.to})
      if (length(p - from) > length(farthest - from)) farthest = p;
  return farthest;
}

}  // namespace

Boundary net_boundary(const OrientedMesh& mesh, const MeshEdges& edges) {
  const std::vector<Numbered> all = edges_in_excess(mesh, edges);
  std::vector<std::uint32_t> ends;
  for (const Numbered& one : all) ends.insert(ends.end(), {one.side.low, one.side.high});
  std::ranges::sort(ends);
  ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
  const auto number_of = [&](std::uint32_t position) {
    return static_cast<std::uint32_t>(std::ranges::lower_bound(ends, position) - ends.begin());
  };
  DisjointSets connected(ends.size());
  for (const Numbered& one : all) connected.join(number_of(one.side.low), number_of(one.side.high));

  // A counting sort by the loops' least positions.
  std::vector<std::uint32_t> loop_of(all.size());
  std::vector<std::size_t> next(ends.size() + 1);
  for (std::size_t n = 0; n < all.size(); ++n) {
    loop_of[n] = connected.find(number_of(all[n].side.low)).set;
    ++next[loop_of[n] + 1];
  }
  Boundary boundary;
  for (std::size_t n = 1; n < next.size(); ++n) {
    if (next[n] > 0) boundary.begin.push_back(boundary.begin.back() + next[n]);
    next[n] += next[n - 1];
  }
  boundary.edges.resize(all.size());
  for (std::size_t n = 0; n < all.size(); ++n) boundary.edges[next[loop_of[n]]++] = placed(mesh.mesh, all[n]);
  return boundary;
}

double length_of(std::span<const BoundaryEdge> loop) {
  double sum = 0;
  for (const BoundaryEdge& edge : loop) sum += length(edge.to - edge.from);
  return sum;
}

double diameter_of(std::span<const BoundaryEdge> loop) {
  if (loop.empty()) return 0;
  // Each search finds a distance at least as large as the one before.
  Vec3 from = loop.front().from, to = from;
  for (int search = 0; search < 4; ++search) from = std::exchange(to, farthest_from(to, loop));
  return length(to - from);
}

}  // namespace standoff
