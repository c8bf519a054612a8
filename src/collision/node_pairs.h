// SPDX-License-Identifier: Apache-2.0
// Pairs of BVH nodes, one of each body of a query, and lower bounds of their distances by oriented boxes. An oriented
// box of a smooth patch is thin: the error of its bound is the square of the patch's size over the radius of curvature,
// whereas the error of spheres and of boxes along fixed axes is the size itself.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <vector>

#include "collision/near_bounds.h"
#include "collision/query_pair.h"
#include "core/threads.h"

namespace standoff::collision {

/// Nodes by level and number; those of level 0 are leaves, of up to sixteen triangles.
struct NodePair {
  float distance_sq;  ///< a lower bound
  std::uint32_t target, probe;
  std::int8_t target_level, probe_level;

  bool is_leaf() const { return target_level == 0 && probe_level == 0; }
};

/// Three perpendicular unit vectors; the first one has the direction of v, or any direction if v is zero.
inline std::array<Vec3, 3> axes_about(const Vec3& v) {
  const PerpendicularAxes axes = perpendicular_axes(triple_of(v));
  return {vec_of(axes.axis[0]), vec_of(axes.axis[1]), vec_of(axes.axis[2])};
}

class NodePairs {
 public:
  explicit NodePairs(const QueryPair& pair)
      : pair_(pair),
        target_(pair.target.body->bvh),
        probe_(pair.probe.body->bvh),
        probe_is_small_(pair.probe_is_small()) {}

  NodePair root() const {
    return {0, 0, 0, static_cast<std::int8_t>(target_.top()), static_cast<std::int8_t>(probe_.top())};
  }

  /// Compares boxes along these vectors too, from now on.
  void set_axes(const LeafAxes& axes) {
    has_axes_ = true;
    axes_ = axes;
  }

  /// Opens the larger node of a pair that is no leaf: writes the pairs with its children whose bound is at most
  /// most_sq, in the order of the children, and returns their number. A bound is never less than the opened pair's.
  int open(const NodePair& nodes, float most_sq, std::array<NodePair, kLanes>& children) const {
    const Obb of_target = target_.box_of(nodes.target_level, nodes.target),
              of_probe = probe_.box_of(nodes.probe_level, nodes.probe);
    const bool opens_target = collision::opens_target(nodes.target_level, of_target, nodes.probe_level, of_probe);
    const BodyBvh& bvh = opens_target ? target_ : probe_;
    const int level = opens_target ? nodes.target_level : nodes.probe_level;
    const std::uint32_t number = opens_target ? nodes.target : nodes.probe;
    const Obb other = opens_target ? in_target(pair_.transform, of_probe) : in_probe(pair_.transform, of_target);
    const float(*const axes)[3] = !has_axes_ ? nullptr : opens_target ? axes_.first : axes_.second;
    alignas(64) float distance_sq[kLanes];
    std::uint32_t near = pair_.kernels.obb_distances_sq(bvh.oriented[static_cast<std::size_t>(level)][number], other,
                                                        axes, most_sq, distance_sq);
    near &= (1u << bvh.children_of(level, number)) - 1;
    if (!opens_target && probe_is_small_) {
      alignas(64) float gap[kLanes];
      pair_.kernels.gaps(pair_.target.body->view, pair_.transform,
                         probe_.spheres[static_cast<std::size_t>(level)][number], std::sqrt(most_sq), gap);
      for (int n = 0; n < kLanes; ++n)
        if (gap[n] > 0) distance_sq[n] = std::max(distance_sq[n], gap[n] * gap[n]);
    }
    int count = 0;
    for (; near != 0; near &= near - 1) {
      const int n = std::countr_zero(near);
      if (!(distance_sq[n] <= most_sq)) continue;  // by the field
      NodePair& child = children[static_cast<std::size_t>(count++)] = nodes;
      child.distance_sq = std::max(distance_sq[n], nodes.distance_sq);
      (opens_target ? child.target : child.probe) = number * kLanes + static_cast<std::uint32_t>(n);
      --(opens_target ? child.target_level : child.probe_level);
    }
    return count;
  }

  /// Calls use(target's leaf, probe's leaf) for each pair of leaves whose boxes may be within `margin`, the nearer
  /// nodes first, until it returns false or the steps are spent. Returns false then.
  template <class Use>
  bool visit_leaves(double margin, Steps& steps, Use use) const {
    const double radii = pair_.target.body->radius + pair_.probe.body->radius;
    const auto reach = static_cast<float>(margin * (1 + kFarShare) + kNodePairSlack * radii + pair_.pose_slack);
    const float most_sq = reach * reach * (kRoundUp * kRoundUp);
    const KeptByThread<std::vector<NodePair>> waiting;
    waiting->assign(1, root());
    std::array<NodePair, kLanes> children;
    while (!waiting->empty()) {
      if (steps.are_spent()) return false;
      steps.take();
      const NodePair next = waiting->back();
      waiting->pop_back();
      if (next.is_leaf()) {
        if (!use(next.target, next.probe)) return false;
        continue;
      }
      const auto end = children.begin() + open(next, most_sq, children);
      std::sort(children.begin(), end,
                [](const NodePair& x, const NodePair& y) { return x.distance_sq > y.distance_sq; });
      waiting->insert(waiting->end(), children.begin(), end);
    }
    return true;
  }

 private:
  const QueryPair& pair_;
  const BodyBvh &target_, &probe_;
  const bool probe_is_small_;
  bool has_axes_ = false;
  LeafAxes axes_;
};

}  // namespace standoff::collision
