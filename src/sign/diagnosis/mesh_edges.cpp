// SPDX-License-Identifier: Apache-2.0
#include "sign/diagnosis/mesh_edges.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <tuple>

#include "core/weld.h"

namespace standoff {

void MeshEdges::find(MeshView mesh, ProgressMeter& progress) {
  const std::size_t triangles = mesh.triangles.size();
  std::vector<std::uint32_t> number(mesh.vertices.size());
  const std::uint32_t count =
      weld([&](std::uint32_t v) { return mesh.vertices[v]; }, number, [&] { progress.check(); });
  corners_.resize(3 * triangles);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, triangles, 4096), [&](const auto& range) {
    for (std::size_t t = range.begin(); t != range.end(); ++t) {
      const Triangle corners = mesh.triangles[t];
      for (std::size_t n = 0; n < 3; ++n) corners_[3 * t + n] = number[corners[n]];
    }
  });

  // Sort by the low end by counting, then the few sides of each low end.
  const auto for_each_side = [&](const auto& use) {
    constexpr std::size_t kCheckEvery = std::size_t{1} << 16;
    for (std::size_t t = 0; t < triangles; ++t) {
      if (t % kCheckEvery == 0) progress.check();
      for (std::uint8_t n = 0; n < 3; ++n) {
        const std::uint32_t from = corners_[3 * t + n], to = corners_[3 * t + (n + 1) % 3];
        if (from == to) continue;
        use(HalfEdge{std::min(from, to), std::max(from, to), static_cast<std::uint32_t>(t), n, from < to});
      }
    }
  };
  progress.check();
  first_.resize(std::size_t{count} + 1);
  for_each_side([&](const HalfEdge& side) { ++first_[side.low + 1]; });
  for (std::size_t n = 0; n < count; ++n) first_[n + 1] += first_[n];
  progress.check();
  half_edges_.resize(first_[count]);
  std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
  for_each_side([&](const HalfEdge& side) { half_edges_[next[side.low]++] = side; });
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, 1024), [&](const auto& range) {
    progress.check();
    for (std::size_t n = range.begin(); n != range.end(); ++n)
      std::sort(half_edges_.begin() + static_cast<std::ptrdiff_t>(first_[n]),
                half_edges_.begin() + static_cast<std::ptrdiff_t>(first_[n + 1]),
                [](const HalfEdge& a, const HalfEdge& b) {
                  return std::tie(a.high, a.triangle, a.corner) < std::tie(b.high, b.triangle, b.corner);
                });
  });
}

DisjointSets MeshEdges::connected_positions() const {
  DisjointSets connected(positions());
  for (std::size_t t = 0; 3 * t < corners_.size(); ++t)
    for (const int corner : {1, 2}) connected.join(position(t, 0), position(t, corner));
  return connected;
}

}  // namespace standoff
