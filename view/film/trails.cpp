// SPDX-License-Identifier: Apache-2.0
#include "view/film/trails.h"

#include <algorithm>
#include <limits>

namespace standoff::view {
namespace {

constexpr std::size_t kMostTrail = 6000, kLeastTrail = 40;  // of all trails together; of one

}  // namespace

void Trails::take(const FlightFrame& frame) {
  const std::size_t bodies = frame.bodies.size();
  if (trails_.empty()) {
    trails_.assign(bodies, {{}, {}, std::numeric_limits<double>::infinity()});
    before_ = frame;
  }
  const std::size_t most = std::max(kLeastTrail, kMostTrail / std::max<std::size_t>(bodies, 1));
  for (std::size_t n = 0; n < bodies; ++n) {
    const Flying &now = frame.bodies[n], &last = before_.bodies[n];
    Trail& trail = trails_[n];
    const bool touched = now.collisions != last.collisions, crossed = now.crossings != last.crossings;
    trail.since_contact = touched ? 0 : trail.since_contact + frame_seconds_;
    if (crossed) crossings_.push_back((last.at + now.at) * 0.5);
    if (!touched && !crossed && !trail.points.empty() && length(now.at - trail.points.back()) < spacing_) continue;
    trail.points.push_back(now.at);
    trail.distances.push_back(now.distance);
    if (trail.points.size() <= most) continue;
    trail.points.pop_front();
    trail.distances.pop_front();
  }
  before_ = frame;
}

}  // namespace standoff::view
