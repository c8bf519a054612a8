// SPDX-License-Identifier: Apache-2.0
// Frames of a flight as bytes: one by one for a page that watches, all together for a page that shows them again.
// view/page/flight_data.js has the other half.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "standoff/vec.h"
#include "view/flight/flight.h"

namespace standoff::view {

/// A frame as it is streamed, little endian: its length in bytes (4, these included), the number of bodies (4), the
/// step (8, a double), steps a second (4, a float), microseconds that a step takes to compute (4, a float); then for
/// each body x, y, z, distance and heading (4 each, floats), its collisions and crossings (4 each).
std::string frame_bytes(const FlightFrame& frame, double steps_per_second, double microseconds);

/// All frames of a recorded flight. Numbers are varints of zigzags (src/page/page.h), which deflate packs well:
/// most of them are 0.
struct CodedFlight {
  Vec3 origin;      ///< the least corner of the box of all positions
  double step = 1;  ///< world units, of positions and distances: the box's longest side in 2^16 - 1 steps
  std::int64_t frames = 0, bodies = 0;
  /// Of each body, of x, y, then z: what is left, in each frame, of the position after a straight continuation of the
  /// two frames before. Nothing is, as long as the body flies straight on.
  std::string positions;
  std::string distances;   ///< of each body: the change in each frame
  std::string headings;    ///< of each body: a float, little endian
  std::string collisions;  ///< of each body: the change in each frame
  std::string crossings;   ///< the same
  std::string steps;       ///< the change in each frame
};
/// Errors: usage (no frame; frames with different numbers of bodies).
CodedFlight coded_flight(std::span<const FlightFrame> frames);

}  // namespace standoff::view
