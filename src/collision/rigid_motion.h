// Rigid motions in the world, and as one body of a pair sees the other move.
#pragma once

#include "collision/pair.h"
#include "collision/relative_motion.h"

namespace standoff::collision {

/// The axis (unit length) and angle, 0 to pi, of a rotation: rotation about `axis` by `angle_rad`.
struct Turn {
  Vec3 axis{0, 0, 1};
  double angle_rad = 0;
};
Turn turn_of(const std::array<double, 9>& rotation);

/// v turned about a unit axis.
Vec3 turned(Vec3 v, Vec3 axis, double angle_rad);

/// A Motion with its turn found once.
struct Course {
  RigidMotion motion;
  Turn turn;              ///< from `from` to `to`, in the world
  Vec3 center, velocity;  ///< of the point the body turns about: its place at time 0, and its way, in the world

  explicit Course(const RigidMotion& motion);
  Pose at(double t) const;
};

/// The way of the pair's tree body in the frame of its field body.
class RelativeMotion {
 public:
  RelativeMotion(const Pair& pair, const Course& course);
  const Way& way() const { return way_; }

  /// The offset of a point of the tree's body (relative to its middle).
  Vec3 offset(Vec3 point) const { return vec_of(way_.offset(triple_of(point))); }
  Vec3 at(Vec3 offset, double t) const { return vec_of(way_.at(triple_of(offset), t)); }
  /// The point moves no faster than this at any time, in world units per unit of time.
  double speed(Vec3 offset) const { return way_.speed(triple_of(offset)); }
  /// Nor does its velocity change faster than this.
  double acceleration(Vec3 offset) const { return way_.acceleration(triple_of(offset)); }

 private:
  Way way_;
};

}  // namespace standoff::collision
