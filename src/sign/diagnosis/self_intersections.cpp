// SPDX-License-Identifier: Apache-2.0
#include "sign/diagnosis/self_intersections.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "geometry/triangle_pair.h"
#include "sign/diagnosis/triangle_tree.h"

namespace standoff {
namespace {

constexpr std::size_t kGroup = 1024;            // triangles between two looks at the limits
constexpr std::int64_t kMostOfTriangle = 4096;  // tests of one triangle

bool share_position(const MeshEdges& edges, std::uint32_t a, std::uint32_t b) {
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (edges.position(a, i) == edges.position(b, j)) return true;
  return false;
}

struct Count {
  std::int64_t pairs = 0, tests = 0;
  bool complete = true;

  friend Count operator+(const Count& a, const Count& b) {
    return {a.pairs + b.pairs, a.tests + b.tests, a.complete && b.complete};
  }
};

}  // namespace

SelfIntersections find_self_intersections(MeshView mesh, const MeshEdges& edges, std::int64_t most_pairs,
                                          std::int64_t most_tests) {
  const TriangleTree triangles(mesh);
  const std::vector<std::uint32_t>& order = triangles.order();
  const BoxTree& tree = triangles.tree();

  const auto count_of = [&](std::size_t n, Count count) {
    const std::array<Vec3, 3> corners = mesh.corners(order[n]);
    std::int64_t left = kMostOfTriangle;
    tree.for_each_later_overlap(n, [&](std::size_t other) {
      if (share_position(edges, order[n], order[other])) return true;
      ++count.tests;
      count.pairs += triangles_intersect(corners, mesh.corners(order[other]));
      return --left > 0;
    });
    count.complete = count.complete && left > 0;
    return count;
  };
  Count total;
  std::size_t next = 0;
  while (next < order.size() && total.pairs < most_pairs && total.tests < most_tests) {
    const std::size_t past = std::min(next + kGroup, order.size());
    total = total + tbb::parallel_reduce(
                        tbb::blocked_range<std::size_t>(next, past, 32), Count{},
                        [&](const auto& range, Count count) {
                          for (std::size_t n = range.begin(); n != range.end(); ++n) count = count_of(n, count);
                          return count;
                        },
                        std::plus<>());
    next = past;
  }
  return {total.pairs, total.complete && next == order.size()};
}

}  // namespace standoff
