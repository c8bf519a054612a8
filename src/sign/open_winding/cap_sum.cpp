// SPDX-License-Identifier: Apache-2.0
#include "sign/open_winding/cap_sum.h"

#include "sign/open_winding/cap_angle.h"

namespace standoff {

Interval add_angles(const Rims& rims, const RimTree& tree, const Vec3& p, const NodeStack& stack,
                    NodeStack::Part leaves, Interval sum) {
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

}  // namespace standoff
