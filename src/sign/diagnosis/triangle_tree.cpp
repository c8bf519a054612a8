// SPDX-License-Identifier: Apache-2.0
#include "sign/diagnosis/triangle_tree.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include "geometry/triangle_box.h"
#include "sign/diagnosis/along_curve.h"

namespace standoff {
namespace {

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
