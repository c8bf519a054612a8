// SPDX-License-Identifier: Apache-2.0
#include "sign/normal/closest_triangle.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "bvh/order.h"

namespace standoff {
namespace {

// All copies of a triangle are equally near; along the curve most of them come one after the other, by index.
std::vector<std::uint32_t> order_without_copies(MeshView mesh, ProgressMeter& progress) {
  std::vector<std::uint32_t> order = morton_order(mesh, {}, progress);
  const auto is_copy = [&](std::uint32_t a, std::uint32_t b) { return mesh.corners(a) == mesh.corners(b); };
  order.erase(std::unique(order.begin(), order.end(), is_copy), order.end());
  return order;
}

Bvh bvh_without_copies(MeshView mesh) {
  ProgressMeter unwatched;
  return {mesh, order_without_copies(mesh, unwatched), frame_around(mesh), unwatched};
}

}  // namespace

ClosestTriangle::ClosestTriangle(MeshView mesh) : mesh_(mesh), bvh_(bvh_without_copies(mesh)) {}

}  // namespace standoff
