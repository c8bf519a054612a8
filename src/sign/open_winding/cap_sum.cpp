// SPDX-License-Identifier: Apache-2.0
#include "sign/open_winding/cap_sum.h"

#include "sign/open_winding/cap_angle.h"

namespace standoff {
namespace {

// Near caps come first: they are what errors are due to, and above `most` nothing more is added.
void add_fields(const Rims& rims, const RimTree& tree, std::int32_t number, const Cell& cell, double tolerance,
                double most, WorkCheck& check, LinearField& sum) {
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

LinearField cap_sum_in(const Rims& rims, const RimTree& tree, const Cell& cell, double tolerance, double most,
                       WorkCheck& check) {
  LinearField sum;
  sum.center = cell.center;
  if (!tree.nodes().empty()) add_fields(rims, tree, 0, cell, tolerance, most, check, sum);
  return sum;
}

}  // namespace standoff
