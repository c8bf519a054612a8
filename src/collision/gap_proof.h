// SPDX-License-Identifier: Apache-2.0
// The proof that no pair of triangles is nearer than a given one: a plane that keeps the bodies as far apart. Many
// pairs may be about equally near, for example between two plates, and no bound in single precision drops them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>

#include "collision/node_pairs.h"
#include "collision/query_pair.h"

namespace standoff::collision {

/// What bounds of pairs of nodes may be off by, in world units.
inline double node_slack(const QueryPair& pair) {
  return kNodePairSlack * (pair.target.body->radius + pair.probe.body->radius) + pair.pose_slack;
}

/// The proofs of a pair: its points, in the world, and their distance.
struct GapProof {
  const QueryPair& pair;
  Vec3 on_target, on_probe;
  double distance;

  /// Unit vectors from the target to the probe: between the points, and along the normals of two triangles. If the
  /// points are near each other, rounding turns the direction between them.
  std::array<Vec3, 3> directions(std::uint32_t of_target, std::uint32_t of_probe) const {
    const Vec3 between = on_probe - on_target;
    const auto normal_of = [](const Corners& t) { return cross(t[1] - t[0], t[2] - t[0]); };
    std::array<Vec3, 3> all{between, normal_of(pair.target.world(of_target)), normal_of(pair.probe.world(of_probe))};
    for (Vec3& along : all) along = axes_about(dot(along, between) < 0 ? -along : along)[0];
    return all;
  }

  /// Whether no pair is nearer by more than the tolerance, because the bodies' boxes, or all corners, leave a gap.
  bool by_boxes(const Vec3& direction, double tolerance) const {
    return gap_of_boxes(direction) >= distance - tolerance - kGapRounding * extent();
  }
  bool by_corners(const Vec3& direction, double tolerance) const {
    return gap_of_corners(direction) >= distance - tolerance - kGapRounding * extent();
  }

  /// Whether such a proof could succeed along any direction n, from any pair, if this pair is the nearest. Then n is
  /// nearly its direction u: its points are in the boxes, so n.u >= 1 - error / distance, and |n - u|^2 <= 2 * error /
  /// distance. From a corner of one box to a corner of the other it is distance * u + w, where w is at most four times
  /// the radii of both bodies. Along u that is less than along n by at most |n - u| |w|, as u.u >= u.n: so is the gap.
  bool boxes_may_prove() const { return may_prove(gap_of_boxes(axes_about(on_probe - on_target)[0])); }
  bool corners_may_prove() const { return may_prove(gap_of_corners(axes_about(on_probe - on_target)[0])); }

 private:
  double radii() const { return pair.target.body->radius + pair.probe.body->radius; }
  double extent() const { return distance + 2 * radii(); }
  bool may_prove(double gap) const {
    const double error = 4 * kGapRounding * extent(), turned = 4 * std::sqrt(error / distance);
    return !(gap < distance - error - turned * 4 * radii());
  }

  double gap_of_boxes(const Vec3& direction) const {
    return -reach_of_box(pair.probe, -direction) - reach_of_box(pair.target, direction);
  }
  double gap_of_corners(const Vec3& direction) const {
    return -reach_of_corners(pair.probe, -direction) - reach_of_corners(pair.target, direction);
  }
  // How far a body reaches along a direction, from the point on the target.
  double reach_along(const PlacedBody& body, const Vec3& direction, const Vec3& corner) const {
    return dot(direction, (body.moved ? apply(body.pose, corner) : corner) - on_target);
  }
  double reach_of_box(const PlacedBody& body, const Vec3& direction) const {
    const Box& box = body.body->box;
    double most = -std::numeric_limits<double>::infinity();
    for (int n = 0; n < 8; ++n) {
      const Vec3 corner{(n & 1 ? box.max : box.min).x, (n & 2 ? box.max : box.min).y, (n & 4 ? box.max : box.min).z};
      most = std::max(most, reach_along(body, direction, corner));
    }
    return most;
  }
  double reach_of_corners(const PlacedBody& body, const Vec3& direction) const {
    double most = -std::numeric_limits<double>::infinity();
    for (const Corners& corners : body.body->corners)
      for (const Vec3& corner : corners) most = std::max(most, reach_along(body, direction, corner));
    return most;
  }
};

}  // namespace standoff::collision
