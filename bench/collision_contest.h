// SPDX-License-Identifier: Apache-2.0
// Collision queries of standoff and of a peer: both run in one program, in turns, so that a noisy machine disturbs both
// equally.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "collision_workload.h"

namespace standoff::bench {

/// A peer of standoff. The first body rests where it was made, the second one is at the pose.
class CollisionPeer {
 public:
  virtual ~CollisionPeer() = default;
  virtual bool collide(const Pose& pose) const = 0;
  /// The number of pairs of triangles that touch, with a point and a normal for each; the peer may stop at `most`
  /// points.
  virtual std::size_t contacts(const Pose& pose, std::size_t most) const = 0;
  /// The distance; 0 if the bodies touch.
  virtual double distance(const Pose& pose) const = 0;
};

/// Builds the peer's models; its time is reported as the build time.
using MakePeer = std::function<std::unique_ptr<CollisionPeer>(const Mesh& a, const Mesh& b)>;

/// A driver: prints a JSON line for each question. For use in main.
int run_collision_contest(int argc, char** argv, const std::string& peer_name, const MakePeer& make_peer);

}  // namespace standoff::bench
