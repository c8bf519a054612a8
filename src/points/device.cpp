// SPDX-License-Identifier: Apache-2.0
#include "points/device.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "core/progress.h"
#include "points/nearest.h"
#include "points/triangle_index.h"

namespace standoff {
namespace {

constexpr float kInfinityFloat = std::numeric_limits<float>::infinity();
constexpr DeviceTree::Node kEmpty{{kInfinityFloat, kInfinityFloat, kInfinityFloat},
                                  {-kInfinityFloat, -kInfinityFloat, -kInfinityFloat}};

DeviceTree::Node around(const DeviceTree::Node& a, const DeviceTree::Node& b) {
  DeviceTree::Node both;
  for (int axis = 0; axis < 3; ++axis) {
    both.low[axis] = std::min(a.low[axis], b.low[axis]);
    both.high[axis] = std::max(a.high[axis], b.high[axis]);
  }
  return both;
}

}  // namespace

DeviceTree::DeviceTree(const TriangleIndex& index)
    : triangles(static_cast<std::uint32_t>(index.triangle_count())),
      leaves(std::bit_ceil(static_cast<std::uint32_t>((std::uint64_t{triangles} + kLeaf - 1) / kLeaf))),
      scale(index.scale()),
      nodes(2 * std::size_t{leaves}, kEmpty),
      corners(9 * std::size_t{triangles}),
      indices(index.bvh().order().data()) {
  for (int axis = 0; axis < 3; ++axis) center[axis] = index.bvh().frame().center[axis] / scale;
  tbb::parallel_for(std::uint32_t{0}, leaves, [&](std::uint32_t leaf) {
    Node& node = nodes[std::size_t{leaves} + leaf];
    const std::uint64_t first = std::uint64_t{leaf} * kLeaf, end = std::min<std::uint64_t>(triangles, first + kLeaf);
    for (std::uint64_t entry = first; entry < end; ++entry) {
      double* to = corners.data() + 9 * entry;
      for (const Vec3& corner : index.mesh().corners(indices[entry])) {
        const double coordinates[3] = {corner.x, corner.y, corner.z};
        for (int axis = 0; axis < 3; ++axis) {
          *to++ = coordinates[axis];
          // The difference is rounded once, whatever the two numbers are: by less than the last bit of a float.
          const auto at = static_cast<float>((coordinates[axis] - center[axis]) * scale);
          node.low[axis] = std::min(node.low[axis], std::nextafter(at, -kInfinityFloat));
          node.high[axis] = std::max(node.high[axis], std::nextafter(at, kInfinityFloat));
        }
      }
    }
  });
  for (std::uint32_t level = leaves / 2; level > 0; level /= 2)
    tbb::parallel_for(level, 2 * level, [&](std::uint32_t n) {
      nodes[n] = around(nodes[2 * std::size_t{n}], nodes[2 * std::size_t{n} + 1]);
    });
  extent = 0;
  for (int axis = 0; axis < 3; ++axis)
    extent = std::max({extent, std::abs(nodes[1].low[axis]), std::abs(nodes[1].high[axis])});
}

// Points are sorted along a Morton curve, so that the threads of a warp visit the same nodes.
void find_nearest_on_device(const PointDevice& device, int number, const DeviceTree& tree, const TriangleIndex& index,
                            const cpu::PointKernels& kernels, std::span<const Vec3> points, FoundTriangles& found,
                            ProgressMeter& progress) {
  SortedPoints& sorted = found.sorted;
  sorted.sort(index, points, found.order, found.points);
  const auto near = static_cast<std::size_t>(sorted.size());
  found.nearest.resize(points.size());
  std::vector<DeviceNearest> answers(near);
  if (near > 0) device.find_nearest({tree, std::span(found.points).first(near), answers, number});
  tbb::parallel_for(std::size_t{0}, near, [&](std::size_t n) {
    found.nearest[n] = {std::sqrt(answers[n].distance_sq) / tree.scale, answers[n].triangle};
  });
  progress.advance(sorted.size());
  find_each(index, kernels, std::span<const Vec3>(found.points).subspan(near), std::span(found.nearest).subspan(near),
            progress);
}

}  // namespace standoff
