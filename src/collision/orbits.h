// SPDX-License-Identifier: Apache-2.0
// What turns in a tight fit never touches, however long it turns: a rotation keeps each point's distance from the axis,
// its place along the axis, and its distance from any point of the axis. Where these differ for two parts of the
// bodies, the parts stay apart during the whole motion, and need not be followed step by step
// (docs/collision_methods.md).
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

#include "collision/body/body.h"
#include "standoff/vec.h"

namespace standoff::collision {

struct Interval {
  double low = std::numeric_limits<double>::infinity(), high = -low;

  void add(double value) { low = std::min(low, value), high = std::max(high, value); }
  void add(const Interval& other) { low = std::min(low, other.low), high = std::max(high, other.high); }
};

/// Bounds of what the rotation keeps, for all points of a part of a body.
struct OrbitBounds {
  Interval from_axis, along_axis, from_center;

  void add(const OrbitBounds& other) {
    from_axis.add(other.from_axis), along_axis.add(other.along_axis), from_center.add(other.from_center);
  }
};

/// A rotation about an axis through `center`, which moves on a straight line.
struct Orbits {
  Vec3 center, axis;                     ///< at time 0; the axis has unit length
  double aside = 0, far = 0;             ///< how far the centre gets: across the axis, and at all
  double along_low = 0, along_high = 0;  ///< along the axis
  double keep = 0;                       ///< parts that are farther apart than this do not touch

  /// The bounds of a triangle.
  OrbitBounds bounds(const Corners& corners) const {
    const Vec3 middle = (corners[0] + corners[1] + corners[2]) * (1.0 / 3) - center;
    const Vec3 outwards = unit(middle), across = unit(middle - axis * dot(middle, axis));
    OrbitBounds b;
    for (const Vec3& corner : corners) {
      const Vec3 arm = corner - center;
      const double along = dot(arm, axis);
      b.along_axis.add(along);
      const Vec3 from_axis = arm - axis * along;
      // The largest distance is that of a corner, as the distance is convex. All of the triangle is at least as far in
      // any direction as the nearest of its corners; the direction may be rounding, where the middle is near the axis.
      b.from_axis.high = std::max(b.from_axis.high, length(from_axis));
      b.from_axis.low = std::min(b.from_axis.low, dot(from_axis, across));
      b.from_center.high = std::max(b.from_center.high, length(arm));
      b.from_center.low = std::min(b.from_center.low, dot(arm, outwards));
    }
    return b;
  }

  /// Whether a part of the resting body and one of the moving body stay apart during the motion.
  bool keep_apart(const OrbitBounds& resting, const OrbitBounds& moving) const {
    return are_apart(resting.from_axis, moving.from_axis, aside) ||
           are_apart(resting.from_center, moving.from_center, far) ||
           resting.along_axis.low - keep > moving.along_axis.high + along_high ||
           moving.along_axis.low + along_low > resting.along_axis.high + keep;
  }

 private:
  static Vec3 unit(const Vec3& v) {
    const double size = length(v);
    return size > 0 ? v * (1 / size) : Vec3{};
  }
  bool are_apart(const Interval& resting, const Interval& moving, double moved) const {
    return resting.low - moved - keep > moving.high || moving.low - keep > resting.high + moved;
  }
};

/// The bounds of all nodes of a body's BVH.
class OrbitTree {
 public:
  OrbitTree() = default;
  /// `to_orbits` brings the body, relative to its middle, to the coordinates of `orbits` at time 0.
  OrbitTree(const Orbits& orbits, const BodyData& body, const Pose& to_orbits) {
    const BodyBvh& bvh = body.bvh;
    levels_.resize(static_cast<std::size_t>(bvh.top()) + 1);
    for (int level = 0; level <= bvh.top(); ++level) {
      std::vector<OrbitBounds>& nodes = levels_[static_cast<std::size_t>(level)];
      nodes.resize(bvh.tree.level(level).size());
      for (std::uint32_t n = 0; n < nodes.size(); ++n)
        for (std::size_t k = n * std::size_t{kLanes}, last = k + bvh.children_of(level, n); k < last; ++k)
          nodes[n].add(level == 0 ? orbits.bounds(placed(body, k, to_orbits))
                                  : levels_[static_cast<std::size_t>(level) - 1][k]);
    }
  }

  bool empty() const { return levels_.empty(); }
  const OrbitBounds& at(int level, std::uint32_t node) const { return levels_[static_cast<std::size_t>(level)][node]; }

  static Corners placed(const BodyData& body, std::size_t triangle, const Pose& to) {
    Corners corners = body.corners[triangle];
    for (Vec3& corner : corners) corner = apply(to, corner - body.middle);
    return corners;
  }

 private:
  std::vector<std::vector<OrbitBounds>> levels_;
};

}  // namespace standoff::collision
