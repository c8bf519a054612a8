// SPDX-License-Identifier: Apache-2.0
// Pairs of BVH nodes, one of a resting body and one of a moving one, and the times until which they stay apart
// (docs/collision_methods.md). It is all in double precision, so that gaps far smaller than the bodies are seen.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

#include "collision/node_pairs.h"
#include "collision/orbits.h"
#include "collision/query_pair.h"
#include "collision/sweep.h"

namespace standoff::collision {

/// Nodes by level and number, as in NodePair, and a time until which they stay apart.
struct MovingNodes {
  double time;
  std::uint32_t resting, moving;
  std::int8_t resting_level, moving_level;
  bool stuck = false;  ///< their boxes are known to show no later time
  float share = 1;     ///< of time_of_size(): how long leaves are followed at once

  bool is_leaf() const { return resting_level == 0 && moving_level == 0; }
};

class MovingNodePairs {
 public:
  /// Body a of the pair rests and body b moves. They are apart where they are farther from each other than `keep`.
  MovingNodePairs(const QueryPair& pair, const AxisAngleMotion& path, double keep)
      : kernels_(pair.kernels),
        resting_(pair.swapped ? pair.probe : pair.target),
        moving_(pair.swapped ? pair.target : pair.probe),
        path_(path),
        frame_(orthonormal(resting_.pose)),
        origin_(apply(resting_.pose, resting_.body->middle)),
        keep_(keep * kRigidRoundUp) {
    velocity_.linear = rotate_back(frame_, path.velocity);
    velocity_.rotation = rotate_back(frame_, path.rotation.axis * path.rotation.angle_rad);
    velocity_.rate = std::max(length(velocity_.rotation), std::numeric_limits<double>::min());
    const double rate = path.rotation.angle_rad;
    axis_ = rotate_back(frame_, path.rotation.axis);
    along_ = dot(velocity_.linear, axis_);
    aside_ = length(velocity_.linear - axis_ * along_);
    // Where the axis goes farther aside, orbits hardly tell anything.
    turns_ = aside_ < rate * moving_.body->radius / 4;
  }

  /// Advances the time as far as the two boxes allow. Returns whether it was far enough for another step to pay.
  bool advance(MovingNodes& nodes) {
    if (nodes.stuck) return false;
    const Boxes boxes = boxes_of(nodes);
    const double before = nodes.time;
    nodes.time += kernels_.obb_free_time(in_double(boxes.resting), placed(boxes.moving), velocity_, keep_);
    return nodes.time - before > kWorthwhileNodeStep * time_of_size(boxes);
  }

  /// How long the moving box takes to move by half the diagonal of the larger one and the distance that is kept, at
  /// least.
  double time_of_size(const MovingNodes& nodes) { return time_of_size(boxes_of(nodes)); }

  /// Opens the larger node of a pair that is no leaf: writes the pairs with its children that may meet before `end`,
  /// and returns their number.
  int open(const MovingNodes& nodes, double end, std::array<MovingNodes, kLanes>& children) {
    const Boxes boxes = boxes_of(nodes);
    const bool opens_resting =
        nodes.moving_level == 0 || (nodes.resting_level > 0 && size_sq(boxes.resting) >= size_sq(boxes.moving));
    const BodyBvh& bvh = (opens_resting ? resting_ : moving_).body->bvh;
    const int level = opens_resting ? nodes.resting_level : nodes.moving_level;
    const std::uint32_t number = opens_resting ? nodes.resting : nodes.moving;
    const Obb16& sixteen = bvh.oriented[static_cast<std::size_t>(level)][number];
    alignas(64) double lasts[kLanes];
    if (opens_resting)
      kernels_.obb_free_times(sixteen, placed(boxes.moving), false, velocity_, keep_, end - nodes.time, lasts);
    else
      kernels_.obb_free_times(sixteen, placed_back(boxes.resting), true, velocity_of_moving(), keep_, end - nodes.time,
                              lasts);
    const int lanes = bvh.children_of(level, number);
    int count = 0;
    for (int n = 0; n < lanes; ++n) {
      const double time = nodes.time + lasts[n];
      if (!(time < end)) continue;
      MovingNodes& child = children[static_cast<std::size_t>(count++)] = nodes;
      child.time = time;
      child.stuck = lasts[n] == 0;
      (opens_resting ? child.resting : child.moving) = number * kLanes + static_cast<std::uint32_t>(n);
      --(opens_resting ? child.resting_level : child.moving_level);
    }
    return count;
  }

  /// The number of leaves of both bodies.
  std::int64_t leaves() const {
    return static_cast<std::int64_t>(resting_.body->bvh.tree.level(0).size() + moving_.body->bvh.tree.level(0).size());
  }

  /// Finds what the rotation keeps of all nodes, if that may tell anything: work for a long search.
  void find_orbits() {
    if (!turns_) return;
    place(0);
    orbits_ = {velocity_.center,      axis_, aside_, length(velocity_.linear), std::min(along_, 0.0),
               std::max(along_, 0.0), keep_};
    orbits_of_resting_ = OrbitTree(orbits_, *resting_.body, Pose{});
    orbits_of_moving_ = OrbitTree(orbits_, *moving_.body, to_resting_);
    start_ = to_resting_;
  }
  /// Whether that shows that two nodes stay apart during the whole motion.
  bool stay_apart(const MovingNodes& nodes) const {
    return !orbits_of_resting_.empty() && orbits_.keep_apart(orbits_of_resting_.at(nodes.resting_level, nodes.resting),
                                                             orbits_of_moving_.at(nodes.moving_level, nodes.moving));
  }

  /// Takes the triangles of two leaves, for approaching().
  void take(const MovingNodes& leaves) {
    const Boxes boxes = boxes_of(leaves);
    resting_count_ = load(*resting_.body, leaves.resting, resting_triangles_);
    moving_count_ = load(*moving_.body, leaves.moving, moving_triangles_);
    const DoubleObb resting = in_double(boxes.resting), moving = placed(boxes.moving);
    for (int k = 0; k < 3; ++k) axes_[k] = resting.axis[k], axes_[3 + k] = moving.axis[k];
    axes_[6] = axes_about(moving.center - resting.center)[0];
    find_pairs(leaves);
  }

  /// Whether any of them may meet at all.
  bool may_meet() const {
    return std::ranges::any_of(may_meet_, [](std::uint32_t lanes) { return lanes != 0; });
  }

  /// For each resting triangle of a leaf bits of the moving ones.
  using LeafPairs = std::array<std::uint32_t, kLanes>;
  /// Finds the pairs of the triangles taken that may meet during some time. Returns their number.
  int approaching(double duration, LeafPairs& pairs) const {
    kernels_.approaching_triangles(resting_triangles_, moving_triangles_, transform_of(to_resting_), velocity_, axes_,
                                   keep_, duration, pairs.data());
    int count = 0;
    for (std::size_t n = 0; n < kLanes; ++n) {
      pairs[n] &= may_meet_[n];
      count += std::popcount(pairs[n]);
    }
    return count;
  }

 private:
  struct Boxes {
    Obb resting, moving;
  };

  // Which of the triangles taken may meet, by their orbits.
  void find_pairs(const MovingNodes& leaves) {
    const std::uint32_t filled = (1u << moving_count_) - 1;
    for (std::size_t n = 0; n < kLanes; ++n) may_meet_[n] = static_cast<int>(n) < resting_count_ ? filled : 0;
    if (orbits_of_resting_.empty()) return;
    std::array<OrbitBounds, kLanes> of_moving;
    for (std::size_t m = 0; m < static_cast<std::size_t>(moving_count_); ++m)
      of_moving[m] = orbits_.bounds(OrbitTree::placed(*moving_.body, leaves.moving * std::size_t{kLanes} + m, start_));
    for (std::size_t n = 0; n < static_cast<std::size_t>(resting_count_); ++n) {
      const OrbitBounds of_resting =
          orbits_.bounds(OrbitTree::placed(*resting_.body, leaves.resting * std::size_t{kLanes} + n, Pose{}));
      for (std::size_t m = 0; m < static_cast<std::size_t>(moving_count_); ++m)
        if (orbits_.keep_apart(of_resting, of_moving[m])) may_meet_[n] &= ~(1u << m);
    }
  }

  // Places the moving body at the pair's time, and returns the boxes, each in the frame of its own body.
  Boxes boxes_of(const MovingNodes& nodes) {
    place(nodes.time);
    return {resting_.body->bvh.box_of(nodes.resting_level, nodes.resting),
            moving_.body->bvh.box_of(nodes.moving_level, nodes.moving)};
  }

  void place(double time) {
    if (time == placed_at_) return;
    placed_at_ = time;
    to_resting_ = orthonormal(relative_pose(frame_, origin_, path_.at(time), moving_.body->middle));
    velocity_.center = rotate_back(frame_, path_.center + path_.velocity * time - origin_);
  }

  static double size_sq(const Obb& box) {
    const Vec3 half{box.half[0], box.half[1], box.half[2]};
    return dot(half, half);
  }
  double time_of_size(const Boxes& boxes) const {
    const double from_center = length(placed(boxes.moving).center - velocity_.center);
    const double speed =
        length(velocity_.linear) + length(velocity_.rotation) * (from_center + std::sqrt(size_sq(boxes.moving)));
    // Points have no size, but still keep their distance.
    return speed > 0 ? (std::sqrt(std::max(size_sq(boxes.resting), size_sq(boxes.moving))) + keep_) / speed
                     : std::numeric_limits<double>::infinity();
  }

  static DoubleObb in_double(const Obb& box) {
    const auto vec = [](const float(&v)[3]) { return Vec3{v[0], v[1], v[2]}; };
    return {vec(box.center),
            {vec(box.axis[0]), vec(box.axis[1]), vec(box.axis[2])},
            {box.half[0], box.half[1], box.half[2]}};
  }
  // A box of the moving body in the resting one's frame.
  DoubleObb placed(const Obb& box) const {
    DoubleObb to = in_double(box);
    to.center = apply(to_resting_, to.center);
    for (Vec3& axis : to.axis) axis = rotate(to_resting_, axis);
    return to;
  }
  // A box of the resting body in the moving one's frame, and the velocity there.
  DoubleObb placed_back(const Obb& box) const {
    DoubleObb to = in_double(box);
    to.center = rotate_back(to_resting_, to.center - to_resting_.translation);
    for (Vec3& axis : to.axis) axis = rotate_back(to_resting_, axis);
    return to;
  }
  RigidVelocity velocity_of_moving() const {
    return {rotate_back(to_resting_, velocity_.linear), rotate_back(to_resting_, velocity_.rotation),
            rotate_back(to_resting_, velocity_.center - to_resting_.translation), velocity_.rate};
  }

  // Writes the triangles of a leaf, relative to the body's middle; lanes left over repeat the last one. Returns their
  // number.
  static int load(const BodyData& body, std::uint32_t leaf, DoubleTriangles& to) {
    const std::uint32_t first = leaf * kLanes;
    const int count = body.bvh.children_of(0, leaf);
    for (int n = 0; n < kLanes; ++n) {
      const Corners& corners = body.corners[first + static_cast<std::uint32_t>(std::min(n, count - 1))];
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec3 at = corners[k] - body.middle;
        to.corner[k][0][n] = at.x, to.corner[k][1][n] = at.y, to.corner[k][2][n] = at.z;
      }
    }
    return count;
  }

  const Kernels& kernels_;
  const PlacedBody &resting_, &moving_;
  const AxisAngleMotion& path_;
  const Pose frame_;   // of the resting body
  const Vec3 origin_;  // its middle in the world
  const double keep_;
  double placed_at_ = -1;
  Pose to_resting_;         // from the moving body's frame, at that time
  RigidVelocity velocity_;  // at that time, in the resting body's frame
  Vec3 axis_;               // of the rotation, in that frame
  double along_, aside_;    // the linear velocity along the axis, and across it
  bool turns_;              // whether orbits may tell anything
  Orbits orbits_;
  OrbitTree orbits_of_resting_, orbits_of_moving_;
  Pose start_;  // from the moving body's frame at time 0
  // The triangles that were taken, and axes that may separate them.
  DoubleTriangles resting_triangles_, moving_triangles_;
  int resting_count_ = 0, moving_count_ = 0;
  LeafPairs may_meet_;
  Vec3 axes_[kLeafAxes];
};

}  // namespace standoff::collision
