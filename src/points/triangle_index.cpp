// SPDX-License-Identifier: Apache-2.0
#include "points/triangle_index.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/triangle_box.h"

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

TriangleIndex::TriangleIndex(MeshView mesh, std::span<const std::uint32_t> among, int threads, Simd simd)
    : job_{mesh, among, grid_around(box_of(mesh, among)), kAll, threads, simd, progress_},
      lattice_(cpu::make_block_lattice(job_.grid, kAll)),
      culling_(job_, lattice_, cpu::kernels_for(simd)),
      corners_(
          std::make_unique_for_overwrite<cpu::TriangleCorners[]>(static_cast<std::size_t>(job_.triangle_count()))) {
  tbb::parallel_for(std::int64_t{0}, job_.triangle_count(), [&](std::int64_t entry) {
    const auto corners = mesh.corners(clusters().triangle(static_cast<std::uint32_t>(entry)));
    for (std::size_t n = 0; n < 3; ++n) {
      double(&at)[3] = corners_[static_cast<std::size_t>(entry)].at[n];
      at[0] = corners[n].x, at[1] = corners[n].y, at[2] = corners[n].z;
    }
  });
}

double TriangleIndex::scale_at(Vec3 point) const {
  const double farthest = std::max(max_norm(local(point)), double{clusters().extent()});
  constexpr int kMostExponent = 64;
  return std::ldexp(scale(), std::min(0, kMostExponent - std::ilogb(farthest)));
}

std::int64_t TriangleIndex::memory_bytes() const {
  return cpu::Clusters::bytes(job_.triangle_count(), 1) +
         job_.triangle_count() * std::int64_t{sizeof(cpu::TriangleCorners)};
}

}  // namespace standoff
