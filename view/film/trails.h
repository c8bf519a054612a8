// SPDX-License-Identifier: Apache-2.0
// What a flight has left behind up to a frame: where its bodies came from, what they touched and passed through.
#pragma once

#include <cstddef>
#include <deque>
#include <span>
#include <vector>

#include "view/flight/flight.h"

namespace standoff::view {

/// The newest part of a body's path.
struct Trail {
  std::deque<Vec3> points;       ///< the oldest first
  std::deque<double> distances;  ///< of each point from the nearest wall, world units
  double since_contact = 0;      ///< seconds; infinite before the first
};

/// Takes the frames of a flight one after another. view/page/flight.js does the same for pages.
class Trails {
 public:
  /// `spacing`: how far apart points are, but for those where something happened, world units.
  Trails(double spacing, double frames_per_second) : spacing_(spacing), frame_seconds_(1 / frames_per_second) {}

  /// The number of bodies must not change.
  void take(const FlightFrame& frame);

  std::span<const Trail> trails() const { return trails_; }
  /// The middles of the ways on which a body passed through a wall.
  std::span<const Vec3> crossings() const { return crossings_; }

 private:
  double spacing_, frame_seconds_;
  FlightFrame before_;
  std::vector<Trail> trails_;
  std::vector<Vec3> crossings_;
};

}  // namespace standoff::view
