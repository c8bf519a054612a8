// SPDX-License-Identifier: Apache-2.0
#include "sign/diagnosis/patches.h"

#include "sign/diagnosis/disjoint_sets.h"
#include "sign/diagnosis/edge_sides.h"

namespace standoff {

Patches find_patches(const MeshEdges& edges, const Copies& copies, std::size_t triangles) {
  DisjointSets sets(triangles);
  std::vector<std::uint32_t> contradictions;
  for_each_edge(edges, copies.use, [&](std::span<const EdgeUse> sides) {
    if (!is_manifold(sides)) return;
    const bool turned = sides[0].forward == sides[1].forward;
    if (!sets.join(sides[0].triangle, sides[1].triangle, turned)) contradictions.push_back(sides[0].triangle);
  });

  Patches found;
  found.of.resize(triangles);
  found.turn.resize(triangles);
  std::vector<std::int64_t> balance;  // of each patch: triangles as the first one, less those turned against it
  for (std::uint32_t t = 0; t < triangles; ++t) {
    const auto [first, turned] = sets.find(t);
    if (first == t) {
      found.of[t] = static_cast<std::uint32_t>(balance.size());
      balance.push_back(0);
    }
    found.of[t] = found.of[first];
    found.turn[t] = turned ? -1 : 1;
    balance[found.of[t]] += found.turn[t];
  }
  for (const auto& [kept, opposite] : copies.either) balance[found.of[kept]] -= found.turn[kept];
  found.unorientable.resize(balance.size());
  for (const std::uint32_t t : contradictions) found.unorientable[found.of[t]] = 1;
  for (std::size_t t = 0; t < triangles; ++t) {
    if (found.unorientable[found.of[t]] != 0)
      found.turn[t] = 1;
    else if (balance[found.of[t]] < 0)
      found.turn[t] = static_cast<std::int8_t>(-found.turn[t]);
    if (!copies.use.empty() && copies.use[t] == 0) found.turn[t] = 0;
  }
  return found;
}

std::int64_t inconsistent_edges(const MeshEdges& edges, std::span<const std::int8_t> use) {
  std::int64_t count = 0;
  for_each_edge(edges, use, [&](std::span<const EdgeUse> sides) {
    if (!is_manifold(sides)) return;
    const auto forward = [&](const EdgeUse& side) { return side.forward == (use.empty() || use[side.triangle] > 0); };
    count += forward(sides[0]) == forward(sides[1]);
  });
  return count;
}

}  // namespace standoff
