// SPDX-License-Identifier: Apache-2.0
#include "points/triangle_index.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "bvh/order.h"
#include "geometry/triangle_box.h"
#include "points/cpu/kernels.h"
#include "simd/dispatch.h"

namespace standoff {
namespace {

// A cube of samples around the triangles.
Grid grid_around(const Box& box) {
  const double side = box.longest_side();
  // Any spacing fits the box of a single point. Otherwise the side must be far above the smallest number, where
  // rounding would spoil the spacing.
  const double spacing = side > std::numeric_limits<double>::min() * 1e6 ? side / (TriangleIndex::kSide - 1) : 1;
  const double reach = spacing * (TriangleIndex::kSide - 1) / 2;
  constexpr std::int64_t n = TriangleIndex::kSide;
  return {{n, n, n}, box.min + (box.max - box.min) * 0.5 - Vec3{reach, reach, reach}, {spacing, spacing, spacing}};
}

Box box_of(MeshView mesh, std::span<const std::uint32_t> among) {
  if (among.empty()) return bounds(mesh);
  Box box;
  for (const std::uint32_t triangle : among) {
    const Box own = triangle_box(mesh, triangle);
    box = {min(box.min, own.min), max(box.max, own.max)};
  }
  return box;
}

constexpr double kAll = std::numeric_limits<double>::infinity();

}  // namespace

TriangleIndex::TriangleIndex(const Mesh& mesh, std::span<const std::uint32_t> among, int threads, Simd simd,
                             ProgressCallback while_built)
    : while_built_(std::move(while_built)),
      job_{mesh, among, grid_around(box_of(mesh, among)), kAll, threads, simd, progress_},
      lattice_(cpu::make_block_lattice(job_.grid, kAll)),
      culling_(job_, lattice_, cpu::kernels_for(simd), halving_order(mesh, among, progress_)),
      frames_(std::make_unique_for_overwrite<cpu::NodeFrames[]>(bvh().level_begin()[1])) {
  tree_.boxes = bvh().boxes();
  tree_.frames = frames_.get();
  tree_.index = bvh().order().data();
  tree_.vertices = &mesh.vertices.data()->x;
  tree_.corners = mesh.triangles.data()->data();
  tree_.triangles = static_cast<std::uint32_t>(job_.triangle_count());
  tree_.top = bvh().top_level();
  std::ranges::copy(bvh().level_begin(), tree_.begin);
  static_assert(sizeof(Vec3) == 3 * sizeof(double) && sizeof(Triangle) == 3 * sizeof(std::uint32_t));
  const cpu::PointKernels& kernels = dispatch_of<cpu::PointKernels>().of(simd, "points");
  const Vec3 middle = bvh().frame().center;
  const double center[3] = {middle.x, middle.y, middle.z};
  tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, tree_.begin[1], 256), [&](const auto& range) {
    progress_.check();
    for (std::uint32_t node = range.begin(); node < range.end(); ++node)
      kernels.make_frames(tree_, node, scale(), center, frames_[node]);
  });
  while_built_ = nullptr;
}

std::int64_t TriangleIndex::memory_bytes() const {
  return cpu::CandidateCulling::bvh_bytes(job_.triangle_count(), 1) +
         tree_.begin[1] * std::int64_t{sizeof(cpu::NodeFrames)};
}

}  // namespace standoff
