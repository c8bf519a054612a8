// SPDX-License-Identifier: Apache-2.0
#include "sign/open_winding/cap_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace standoff {

// Far fields, and their tree.

namespace {

using Skew = std::array<double, 6>;

void add_outer(Skew& skew, const Vec3& a, const Vec3& b) {
  const Skew outer = {a.x * b.x,
                      a.y * b.y,
                      a.z * b.z,
                      (a.x * b.y + a.y * b.x) / 2,
                      (a.y * b.z + a.z * b.y) / 2,
                      (a.z * b.x + a.x * b.z) / 2};
  for (std::size_t n = 0; n < outer.size(); ++n) skew[n] += outer[n];
}

void finish(Moments& caps) {
  caps.radius *= 1 + 1e-12;
  caps.error_reach = std::sqrt(std::sqrt(3 * caps.inertia));
  const double third = (caps.skew[0] + caps.skew[1] + caps.skew[2]) / 3;
  for (std::size_t n = 0; n < 3; ++n) caps.skew[n] -= third;
  const Skew& s = caps.skew;
  caps.area_norm = length(caps.area);
  // The singular values of a 3x3 matrix add up to at most sqrt(3) times its Frobenius norm.
  caps.skew_norm =
      std::sqrt(3 * (s[0] * s[0] + s[1] * s[1] + s[2] * s[2] + 2 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5])));
}

Vec3 times(const Skew& s, const Vec3& v) {
  return {s[0] * v.x + s[3] * v.y + s[5] * v.z, s[3] * v.x + s[1] * v.y + s[4] * v.z,
          s[5] * v.x + s[4] * v.y + s[2] * v.z};
}

Moments moments_of(const Rim& rim) {
  constexpr double k4Pi = 4 * std::numbers::pi;
  Moments caps;
  const auto for_each_triangle = [&](const auto& use) {
    Vec3 corner = rim.corners.back();
    for (const Vec3& next : rim.corners) {
      const Vec3 area = cross(corner - rim.apex, next - rim.apex) * (0.5 * rim.weight / k4Pi);
      use(corner, next, area, length(area));
      corner = next;
    }
  };
  Vec3 sum;  // of centroids relative to the apex, for meshes far from the origin
  for_each_triangle([&](const Vec3& corner, const Vec3& next, const Vec3& area, double size) {
    caps.area = caps.area + area;
    caps.total += size;
    sum = sum + ((corner - rim.apex) + (next - rim.apex)) * (size / 3);
  });
  caps.center = caps.total > 0 ? rim.apex + sum * (1 / caps.total) : rim.apex;
  const Vec3 w = rim.apex - caps.center;
  caps.radius = length(w);
  for_each_triangle([&](const Vec3& corner, const Vec3& next, const Vec3& area, double size) {
    const Vec3 u = corner - caps.center, v = next - caps.center;
    caps.radius = std::max(caps.radius, length(v));
    add_outer(caps.skew, area, (u + v + w) * (1 / 3.0));
    caps.inertia += size / 6 * (dot(u, u) + dot(v, v) + dot(w, w) + dot(u, v) + dot(v, w) + dot(w, u));
  });
  finish(caps);
  return caps;
}

Moments joined(const Moments& a, const Moments& b) {
  Moments caps{.area = a.area + b.area, .total = a.total + b.total};
  const double share = caps.total > 0 ? b.total / caps.total : 0.5;
  caps.center = a.center + (b.center - a.center) * share;
  for (const Moments* part : {&a, &b}) {
    const Vec3 d = part->center - caps.center;
    caps.radius = std::max(caps.radius, length(d) + part->radius);
    for (std::size_t n = 0; n < caps.skew.size(); ++n) caps.skew[n] += part->skew[n];
    add_outer(caps.skew, part->area, d);
    caps.inertia += part->inertia + part->total * dot(d, d);  // both centers are centroids
  }
  finish(caps);
  return caps;
}

}  // namespace

bool add_far_field(const Moments& caps, const Cell& cell, const FieldTolerance& tolerance, LinearField& sum) {
  // docs/open_winding.md derives these bounds.
  const double d_sq = cell.distance_sq(caps.center);
  if (tolerance.is_near(caps, d_sq)) return false;
  const double d = std::sqrt(d_sq), gap = d - caps.radius, gap_sq = gap * gap;
  const double error = 3 * caps.inertia / (gap_sq * gap_sq) +
                       cell.radius * cell.radius * (3 * caps.area_norm + 12 * caps.skew_norm / d) / (d_sq * d_sq);
  if (!(error <= tolerance.in_cell())) return false;
  const Vec3 r = caps.center - cell.center, skew_r = times(caps.skew, r);
  const double i2 = 1 / dot(r, r), i3 = i2 * std::sqrt(i2), area_r = dot(caps.area, r), r_skew_r = dot(r, skew_r);
  sum.value += i3 * (area_r - 3 * i2 * r_skew_r);
  sum.gradient = sum.gradient + (r * (3 * i2 * (area_r - 5 * i2 * r_skew_r)) - caps.area + skew_r * (6 * i2)) * i3;
  sum.error += error;
  return true;
}

std::optional<Interval> far_field_at(const Moments& caps, const Vec3& p, const FieldTolerance& tolerance) {
  const Vec3 r = caps.center - p;
  const double d_sq = dot(r, r);
  if (tolerance.is_near(caps, d_sq)) return {};
  const double i1 = 1 / std::sqrt(d_sq), i2 = i1 * i1, nearness = caps.error_reach / (d_sq * i1 - caps.radius),
               nearness_sq = nearness * nearness;
  return Interval{i1 * i2 * (dot(caps.area, r) - 3 * i2 * dot(r, times(caps.skew, r))), nearness_sq * nearness_sq};
}

double bound_of_field(const Moments& caps, const Cell& cell) {
  const double gap = std::sqrt(cell.distance_sq(caps.center)) - caps.radius;
  return gap > 0 ? caps.total / (gap * gap) : std::numeric_limits<double>::infinity();
}

void RimTree::make(const Rims& rims, ProgressMeter& progress) {
  WorkCheck check(progress, 1 << 16);
  std::vector<Moments> moments(rims.size());
  std::vector<std::int32_t> order(rims.size());
  for (std::size_t n = 0; n < rims.size(); ++n) {
    check.add(1);
    moments[n] = moments_of(rims[n]);
    order[n] = static_cast<std::int32_t>(n);
  }
  nodes_.reserve(2 * rims.size());
  if (!order.empty()) build(order, moments, check);
}

void RimTree::build(std::span<std::int32_t> rims, std::span<const Moments> moments, WorkCheck& check) {
  check.add(static_cast<std::int64_t>(rims.size()));
  const auto of = [&](std::int32_t rim) -> const Moments& { return moments[static_cast<std::size_t>(rim)]; };
  const std::size_t node = nodes_.size();
  nodes_.emplace_back();
  if (rims.size() == 1) {
    nodes_[node] = {of(rims[0]), 0, rims[0]};
    return;
  }
  Box centers;
  for (const std::int32_t rim : rims) centers.include(of(rim).center);
  const Vec3 e = centers.extent();
  double Vec3::*const axis = e.x >= e.y && e.x >= e.z ? &Vec3::x : e.y >= e.z ? &Vec3::y : &Vec3::z;
  const std::size_t half = rims.size() / 2;
  std::nth_element(rims.begin(), rims.begin() + static_cast<std::ptrdiff_t>(half), rims.end(),
                   [&](std::int32_t a, std::int32_t b) {
                     const double at_a = of(a).center.*axis, at_b = of(b).center.*axis;
                     return at_a != at_b ? at_a < at_b : a < b;
                   });
  build(rims.first(half), moments, check);
  nodes_[node].right = static_cast<std::int32_t>(nodes_.size());
  build(rims.subspan(half), moments, check);
  nodes_[node].caps = joined(nodes_[node + 1].caps, (*this)[nodes_[node].right].caps);
}

// The sum of all caps in double.

namespace {

// Adds near caps first: they cause most of the error, and beyond `most` nothing more is added.
void add_fields(const Rims& rims, const RimTree& tree, std::int32_t number, const Cell& cell,
                const FieldTolerance& tolerance, double most, WorkCheck& check, LinearField& sum) {
  check.add(1);
  const RimTree::Node& node = tree[number];
  if (!(sum.error <= most) || add_far_field(node.caps, cell, tolerance, sum)) return;
  if (node.is_leaf()) return sum.add(cap_field(rims[static_cast<std::size_t>(node.rim)], cell));
  const Vec3 left = tree[number + 1].caps.center - cell.center, right = tree[node.right].caps.center - cell.center;
  const bool is_left_near = dot(left, left) <= dot(right, right);
  add_fields(rims, tree, is_left_near ? number + 1 : node.right, cell, tolerance, most, check, sum);
  add_fields(rims, tree, is_left_near ? node.right : number + 1, cell, tolerance, most, check, sum);
}

}  // namespace

Interval add_angles(const Rims& rims, const RimTree& tree, const Vec3& p, NodeStack& stack, NodeStack::Part leaves,
                    Interval sum) {
  stack.count(leaves.end - leaves.begin);
  for (std::size_t n = leaves.begin; n < leaves.end; ++n) {
    const CapAngle angle = cap_angle(rims[static_cast<std::size_t>(tree[stack[n]].rim)], p);
    sum.value += angle.value;
    sum.error += angle.error;
  }
  return sum;
}

Interval cap_sum_at(const Rims& rims, const RimTree& tree, const Vec3& p, double tolerance, NodeStack& stack) {
  const std::size_t size = stack.size();
  LinearField far;
  far.center = p;
  const NodeStack::Part near = stack.add_far(stack.root(), {p, {}, 0}, tolerance, 0, far);
  const Interval sum = add_angles(rims, tree, p, stack, near, {far.value, far.error});
  stack.resize(size);
  return sum;
}

LinearField cap_sum_in(const Rims& rims, const RimTree& tree, const Cell& cell, const FieldTolerance& tolerance,
                       double most, WorkCheck& check) {
  LinearField sum;
  sum.center = cell.center;
  if (!tree.nodes().empty()) add_fields(rims, tree, 0, cell, tolerance, most, check, sum);
  return sum;
}

}  // namespace standoff
