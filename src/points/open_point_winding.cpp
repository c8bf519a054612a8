// SPDX-License-Identifier: Apache-2.0
#include "points/open_point_winding.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "sign/open_winding/winding_rule.h"

namespace standoff {
namespace {

// A sum of fields is not worth being made finer, as for samples.
constexpr double kFinest = 1e-9;

}  // namespace

OpenPointWinding::OpenPointWinding(const OrientedMesh& mesh, const TriangleIndex& index, const Boundary& boundary,
                                   int threads, Simd simd)
    : mesh_(mesh, index),
      rims_(boundary),
      tree_(rims_),
      caps_(caps_of(rims_)),
      cap_index_(std::make_unique<TriangleIndex>(caps_, std::span<const std::uint32_t>{}, threads, simd)) {}

std::int32_t OpenPointWinding::closed(Vec3 point, const cpu::PointKernels& kernels) const {
  // Closed are only both together: one way for both.
  const RayWay way = mesh_.shortest(point);
  return mesh_.at(point, way, kernels) + RayWinding({caps_}, *cap_index_).at(point, way, kernels);
}

double OpenPointWinding::at(Vec3 point, const cpu::PointKernels& kernels, WorkCheck& check) const {
  NodeStack stack(tree_, check);
  return closed(point, kernels) + cap_sum_at(rims_, tree_, point, 0, stack).value;
}

template <class Closed>
bool OpenPointWinding::side(Vec3 point, WindingRule rule, double most, const Closed& closed_of,
                            WorkCheck& check) const {
  NodeStack stack(tree_, check);
  for (double tolerance = kFieldTolerance;;) {
    const Interval angles = cap_sum_at(rims_, tree_, point, tolerance, stack);
    const double winding = closed_of(angles.value) + angles.value, off = angles.error + kWindingRounding,
                 allowed = std::min(margin(winding, rule), most);
    if (tolerance == 0 || off < allowed) return is_inside(winding, rule);
    // Errors are sums of many: about as much smaller as each of them, and never quite.
    tolerance = tolerance > kFinest ? tolerance * std::clamp(allowed / off / 2, 1.0 / 64, 1.0 / 16) : 0;
  }
}

bool OpenPointWinding::side(Vec3 point, WindingRule rule, const cpu::PointKernels& kernels, WorkCheck& check) const {
  const std::int32_t whole = closed(point, kernels);
  return side(
      point, rule, std::numeric_limits<double>::infinity(), [&](double) { return whole; }, check);
}

bool OpenPointWinding::side(Vec3 point, WindingRule rule, const Interval& about, WorkCheck& check) const {
  // The whole part is right if both errors together are below 1/2.
  return side(
      point, rule, 0.49 - about.error, [&](double angles) { return std::round(about.value - angles); }, check);
}

LinearField OpenPointWinding::field(const Cell& cell, double tolerance, double most, WorkCheck& check) const {
  return cap_sum_in(rims_, tree_, cell, tolerance, most, check);
}

std::int64_t OpenPointWinding::memory_bytes() const {
  return cap_index_->memory_bytes() + static_cast<std::int64_t>(caps_.triangles.size() * 2 * sizeof(Triangle)) +
         static_cast<std::int64_t>(tree_.nodes().size() * sizeof(RimTree::Node));
}

}  // namespace standoff
