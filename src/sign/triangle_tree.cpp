// SPDX-License-Identifier: Apache-2.0
#include "sign/triangle_tree.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>

#include "geometry/morton.h"
#include "geometry/triangle_box.h"

namespace standoff {
namespace {

// The triangles, near ones together.
std::vector<std::uint32_t> along_curve(MeshView mesh) {
  constexpr double kCells = 1 << 10;
  const Box bounds = standoff::bounds(mesh);
  const double side = bounds.longest_side(), scale = side > 0 ? (kCells - 1) / side : 0;
  const std::size_t triangles = mesh.triangles.size();
  std::vector<std::uint64_t> keys(triangles);  // cell, triangle
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, triangles, 4096), [&](const auto& range) {
    for (std::size_t t = range.begin(); t != range.end(); ++t) {
      const Vec3 at = (triangle_box(mesh, t).center() - bounds.min) * scale;
      keys[t] = morton(std::uint64_t(at.x), std::uint64_t(at.y), std::uint64_t(at.z)) << 32 | t;
    }
  });
  std::ranges::sort(keys);
  std::vector<std::uint32_t> order(triangles);
  for (std::size_t n = 0; n < triangles; ++n) order[n] = static_cast<std::uint32_t>(keys[n]);
  return order;
}

std::vector<Box> boxes_of(MeshView mesh, const std::vector<std::uint32_t>& order) {
  std::vector<Box> boxes(order.size());
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, order.size(), 4096), [&](const auto& range) {
    for (std::size_t n = range.begin(); n != range.end(); ++n) boxes[n] = triangle_box(mesh, order[n]);
  });
  return boxes;
}

}  // namespace

TriangleTree::TriangleTree(MeshView mesh) : order_(along_curve(mesh)), tree_(boxes_of(mesh, order_)) {}

}  // namespace standoff
