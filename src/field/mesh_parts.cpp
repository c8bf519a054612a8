// SPDX-License-Identifier: Apache-2.0
#include "field/mesh_parts.h"

#include <algorithm>

#include "bvh/order.h"

namespace standoff {

MeshParts::MeshParts(MeshView mesh, std::span<const std::uint32_t> among, ProgressMeter& progress)
    : bvh_(mesh, morton_order(mesh, among, progress), frame_around(mesh), progress) {}

std::int64_t MeshParts::bytes(std::int64_t triangles) {
  constexpr std::int64_t kInPart = sizeof(std::uint32_t) + sizeof(Triangle) + sizeof(std::int8_t);
  return Bvh::bytes_of(triangles) + kInPart * triangles;
}

bool MeshParts::follow(MeshView mesh, std::span<const std::uint32_t> moved) {
  if (place_of_.empty()) {
    place_of_.resize(bvh_.triangles());
    for (std::uint32_t place = 0; place < bvh_.triangles(); ++place) place_of_[bvh_.order()[place]] = place;
  }
  std::vector<std::uint32_t> places(moved.size());
  std::ranges::transform(moved, places.begin(), [&](std::uint32_t triangle) { return place_of_[triangle]; });
  std::ranges::sort(places);
  return bvh_.follow(mesh, places);
}

// Boxes of the hierarchy lie within twice its extent; what is far beyond need not fit into float.
FloatBox MeshParts::local(const Box& box) const {
  const BvhFrame& frame = bvh_.frame();
  const double far = 4.0 * frame.extent;
  const Vec3 low = frame.local(box.min), high = frame.local(box.max);
  FloatBox made;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    made.low[axis] = static_cast<float>(std::clamp(low[axis], -far, far));
    made.high[axis] = static_cast<float>(std::clamp(high[axis], -far, far));
  }
  return made;
}

void MeshParts::sort_ascending(std::vector<std::uint32_t>& triangles) {
  constexpr std::size_t kMany = 4096;
  if (triangles.size() < kMany) {
    std::ranges::sort(triangles);
    return;
  }
  std::vector<KeyedIndex> keyed(triangles.size());
  std::ranges::transform(triangles, keyed.begin(), [](std::uint32_t t) { return KeyedIndex{t, t}; });
  radix_sort(keyed, 1);
  std::ranges::transform(keyed, triangles.begin(), &KeyedIndex::index);
}

std::vector<std::uint32_t> MeshParts::touching(const Box& box) const {
  return touching(box, [](std::uint32_t) { return true; });
}

bool MeshParts::touch(const Box& box) const {
  bool any = false;
  const auto meets = [&any](const Boxes16& boxes, const FloatBox& one) { return any ? 0u : overlapping(boxes, one); };
  for_each_overlap(bvh_, local(box), meets, [&](std::uint32_t) { any = true; });
  return any;
}

MeshPart::MeshPart(const OrientedMesh& mesh, std::span<const std::uint32_t> among) : vertices_(mesh.mesh.vertices) {
  triangles_.reserve(among.size());
  for (const std::uint32_t triangle : among) triangles_.push_back(mesh.mesh.triangles[triangle]);
  if (mesh.use.empty()) return;
  use_.reserve(among.size());
  for (const std::uint32_t triangle : among) use_.push_back(mesh.use[triangle]);
}

}  // namespace standoff
