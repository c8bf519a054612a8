// Two placed bodies, one giving its field and the other its tree.
#pragma once

#include <algorithm>

#include "collision/body/model.h"
#include "collision/cpu/kernels.h"

namespace standoff::collision {

/// A pose as kernels take it.
inline DoublePlace place_of(const Pose& pose) {
  DoublePlace place;
  for (int n = 0; n < 9; ++n) place.rotation[n] = pose.rotation[n];
  place.translation[0] = pose.translation.x;
  place.translation[1] = pose.translation.y;
  place.translation[2] = pose.translation.z;
  return place;
}

/// A body in the world.
struct Placed {
  const ModelData* body;
  Pose pose;
  bool moved;  ///< the pose is not the identity

  Placed(const ModelData& data, const Pose& at) : body(&data), pose(at), moved(!(at == Pose{})) {}
  /// The corners in the world of a triangle, by its place in the tree: what all exact answers are about.
  Corners world(std::uint32_t place) const {
    const Corners& c = body->corners[place];
    if (!moved) return c;
    return {apply(pose, c[0]), apply(pose, c[1]), apply(pose, c[2])};
  }
  std::uint32_t triangle(std::uint32_t place) const { return body->tree.order[place]; }
};

/// `field` is the body whose field is asked, the larger one; `tree` the one whose balls are placed in it. `place` takes
/// coordinates of the tree's body to those of the field's, both relative to their middles.
struct Pair {
  Placed field, tree;
  bool swapped;  ///< a is the tree
  /// The field's frame: its pose, with a rotation to rounding. What a pose's matrix is off then counts for no more than
  /// the body itself, however far away the other one is.
  Pose frame;
  Pose relative;
  FloatPlace place;
  /// The coordinates that placing both bodies in the world goes through are no larger.
  double far;
  /// How much bounds in single precision, in the field's frame, may be wrong about the world: see pair.cpp.
  float slack;

  Pair(const CollisionModel& a, const Pose& pose_a, const CollisionModel& b, const Pose& pose_b);

  /// A lower bound of the distance of the bodies from the tree's ball and the field's box alone.
  double root_gap() const;
  /// Balls and boxes farther apart than this are farther than the margin.
  float limit(double margin) const { return static_cast<float>(margin) * 1.000001f + slack; }
  /// The bodies are farther apart than the margin, from that ball and that box alone.
  bool apart(double margin) const { return root_gap() > margin + slack; }
  /// A box around the tree's body in the field's frame, grown by `by`.
  FloatBox region(float by) const;
  /// A triangle of the tree's body, in the field's frame.
  FloatBox box_of(std::uint32_t place_in_tree) const;
};

/// The lanes whose gap is at most `limit`, the nearest first. Returns how many.
inline int lanes_within(const float (&gap)[kLanes], float limit, int (&lanes)[kLanes]) {
  int count = 0;
  for (int n = 0; n < kLanes; ++n)
    if (gap[n] <= limit) lanes[count++] = n;
  std::sort(lanes, lanes + count, [&gap](int a, int b) { return gap[a] < gap[b]; });
  return count;
}

}  // namespace standoff::collision
