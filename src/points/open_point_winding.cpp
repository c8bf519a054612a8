// SPDX-License-Identifier: Apache-2.0
#include "points/open_point_winding.h"

#include <algorithm>

#include "sign/open_winding/cap_sum.h"
#include "sign/open_winding/winding_rule.h"

namespace standoff {
namespace {

// What rounding leaves of a sum of angles, and where a sum of fields is not worth being made finer: as for samples.
constexpr double kRounding = 1e-12, kFinest = 1e-9;

}  // namespace

OpenPointWinding::OpenPointWinding(const OrientedMesh& mesh, const TriangleIndex& index, const Boundary& boundary,
                                   int threads, Simd simd)
    : mesh_(mesh, index),
      rims_(boundary),
      tree_(rims_),
      caps_(caps_of(rims_)),
      cap_index_(std::make_unique<TriangleIndex>(caps_, std::span<const std::uint32_t>{}, threads, simd)) {}

std::int32_t OpenPointWinding::closed_winding(Vec3 point, const cpu::PointKernels& kernels) const {
  // Closed are only both together: one way for both.
  const RayWay way = mesh_.shortest(point);
  return mesh_.at(point, way, kernels) + RayWinding({caps_}, *cap_index_).at(point, way, kernels);
}

double OpenPointWinding::at(Vec3 point, const cpu::PointKernels& kernels) const {
  NodeStack stack(tree_);
  return closed_winding(point, kernels) + cap_sum_at(rims_, tree_, point, 0, stack).value;
}

OpenPointWinding::Side OpenPointWinding::side(Vec3 point, WindingRule rule, const cpu::PointKernels& kernels) const {
  const std::int32_t closed = closed_winding(point, kernels);
  NodeStack stack(tree_);
  for (double tolerance = kFieldTolerance;; tolerance = tolerance > kFinest ? tolerance / 64 : 0) {
    const Interval angles = cap_sum_at(rims_, tree_, point, tolerance, stack);
    const double winding = closed + angles.value, certain = margin(winding, rule) - angles.error - kRounding;
    if (tolerance == 0 || certain > 0) return {is_inside(winding, rule), std::max(certain, 0.0)};
  }
}

std::int64_t OpenPointWinding::memory_bytes() const {
  return cap_index_->memory_bytes() + static_cast<std::int64_t>(caps_.triangles.size() * 2 * sizeof(Triangle)) +
         static_cast<std::int64_t>(tree_.nodes().size() * sizeof(RimTree::Node));
}

}  // namespace standoff
