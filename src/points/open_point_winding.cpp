// SPDX-License-Identifier: Apache-2.0
#include "points/open_point_winding.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "core/threads.h"
#include "sign/open_winding/caps.h"
#include "sign/signs.h"

namespace standoff {
namespace {

// A sum of fields is not worth being made finer, as for samples.
constexpr double kFinest = 1e-9;
// How many triangles are added up in the time of a boundary's edge: measured, and arbitrary within a factor of two.
constexpr std::size_t kTrianglesOfEdge = 4;

// The leaves among the node and all below it whose fields are not known to `tolerance`; the other fields are added.
void add_far(const RimTree& tree, std::int32_t number, const Cell& cell, double tolerance, LinearField& far,
             std::vector<std::int32_t>& near, WorkCheck& check) {
  check.add(1);
  const RimTree::Node& node = tree[number];
  if (add_far_field(node.caps, cell, tolerance, far)) return;
  if (node.is_leaf()) return near.push_back(number);
  add_far(tree, number + 1, cell, tolerance, far, near, check);
  add_far(tree, node.right, cell, tolerance, far, near, check);
}

}  // namespace

OpenPointWinding::OpenPointWinding(const OrientedMesh& mesh, const TriangleIndex& index, const Boundary& boundary,
                                   int threads, Simd simd)
    : oriented_(mesh),
      index_(index),
      triangles_cost_less_(mesh.mesh.triangles.size() < kTrianglesOfEdge * boundary.edges.size()),
      mesh_(mesh, index),
      rims_(boundary),
      tree_(rims_),
      caps_(caps_of(rims_)),
      cap_index_(std::make_unique<TriangleIndex>(caps_, std::span<const std::uint32_t>{}, threads, simd)) {}

std::int32_t OpenPointWinding::closed(Vec3 point, const cpu::PointKernels& kernels) const {
  // Closed are only both together: one way for both.
  const RayWay way = mesh_.shortest(point);
  return mesh_.at(point, way, kernels) + RayWinding({caps_}, *cap_index_).at(point, way, kernels);
}

Interval OpenPointWinding::cap_sum(Vec3 point, double tolerance, WorkCheck& check) const {
  const KeptByThread<std::vector<std::int32_t>> near;
  near->clear();
  LinearField far;
  far.center = point;
  if (!tree_.nodes().empty()) add_far(tree_, 0, {point, {}, 0}, tolerance, far, *near, check);
  Interval sum{far.value, far.error};
  for (const std::int32_t leaf : *near) {
    check.add(1);
    const CapAngle angle = cap_angle(rims_[static_cast<std::size_t>(tree_[leaf].rim)], point);
    sum.value += angle.value;
    sum.error += angle.error;
  }
  return sum;
}

std::optional<double> OpenPointWinding::sum_of_triangles(Vec3 point, const cpu::PointKernels& kernels) const {
  cpu::SolidAngles angles;
  angles.scale = index_.scale_at(point);
  const Vec3 at = point * angles.scale;
  angles.at[0] = at.x, angles.at[1] = at.y, angles.at[2] = at.z, angles.at[3] = 0;
  kernels.add_solid_angles(index_.tree(), oriented_.use.empty() ? nullptr : oriented_.use.data(), angles);
  if (!angles.is_certain) return {};
  double sum = 0;
  for (int n = 0; n < cpu::SolidAngles::kCount; ++n)
    sum += angles.around[n] + std::atan2(angles.im[n], angles.re[n]) / (2 * std::numbers::pi);
  for (int n = 0; n < angles.flat_count; ++n) {
    const std::array<Vec3, 3> t = oriented_.corners(angles.flat[n]);
    sum += 0.5 * side_of_plane(t[0], t[2], t[1], point);  // 1 on the inner side, where the corners turn clockwise
  }
  return sum;
}

double OpenPointWinding::at(Vec3 point, const cpu::PointKernels& kernels, WorkCheck& check) const {
  if (triangles_cost_less_) {
    check.add(static_cast<std::int64_t>(oriented_.mesh.triangles.size() / kTrianglesOfEdge));
    if (const std::optional<double> sum = sum_of_triangles(point, kernels)) return *sum;
  }
  return closed(point, kernels) + cap_sum(point, 0, check).value;
}

template <class Closed>
bool OpenPointWinding::side(Vec3 point, WindingRule rule, double most, const Closed& closed_of,
                            WorkCheck& check) const {
  for (double tolerance = kFieldTolerance;;) {
    const Interval angles = cap_sum(point, tolerance, check);
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
