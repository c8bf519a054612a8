// SPDX-License-Identifier: Apache-2.0
#include "points/triangle_index.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "field/cpu/clusters.h"
#include "geometry/triangle_box.h"
#include "points/cpu/kernels.h"

namespace standoff {
namespace {

// A cube of samples around the triangles.
Grid grid_around(const Box& box) {
  const double side = box.longest_side();
  // Of a point's box, any; else far above where the spacing's own rounding would matter.
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
      culling_(job_, lattice_, cpu::kernels_for(simd), cpu::halving_order(job_)),
      frames_(std::make_unique_for_overwrite<cpu::FramePack[]>(clusters().level_begin()[1])) {
  tree_.packs = clusters().packs();
  tree_.frames = frames_.get();
  tree_.index = clusters().indices();
  tree_.vertices = &mesh.vertices.data()->x;
  tree_.corners = mesh.triangles.data()->data();
  tree_.triangles = static_cast<std::uint32_t>(job_.triangle_count());
  tree_.top = static_cast<int>(clusters().level_begin().size()) - 2;
  std::ranges::copy(clusters().level_begin(), tree_.begin);
  static_assert(sizeof(Vec3) == 3 * sizeof(double) && sizeof(Triangle) == 3 * sizeof(std::uint32_t));
  const cpu::PointKernels& kernels = cpu::point_kernels_for(simd);
  const double(&center)[3] = clusters().center();
  tbb::parallel_for(tbb::blocked_range<std::uint32_t>(0, tree_.begin[1], 256), [&](const auto& range) {
    progress_.check();
    for (std::uint32_t pack = range.begin(); pack < range.end(); ++pack)
      kernels.make_frames(tree_, pack, scale(), center, frames_[pack]);
  });
  while_built_ = nullptr;
}

double TriangleIndex::scale_at(Vec3 point) const {
  const double farthest = std::max(max_norm(local(point)), double{clusters().extent()});
  constexpr int kMostExponent = 64;
  if (farthest < 0x1p64) return scale();
  // A point may be too far for grid units of a tiny mesh.
  const int exponent =
      std::isfinite(farthest) ? std::ilogb(farthest) : std::ilogb(max_norm(point)) + std::ilogb(scale());
  return std::ldexp(scale(), std::min(0, kMostExponent - exponent));
}

std::int64_t TriangleIndex::memory_bytes() const {
  return cpu::Clusters::bytes(job_.triangle_count(), 1) + tree_.begin[1] * std::int64_t{sizeof(cpu::FramePack)};
}

}  // namespace standoff
