// SPDX-License-Identifier: Apache-2.0
// A flight as pictures in memory, and the trails that its bodies leave on them.
#pragma once

#include <cstddef>
#include <deque>
#include <span>
#include <vector>

#include "core/threads.h"
#include "fly/flight.h"
#include "fly/flight_page.h"
#include "render/stage.h"
#include "standoff/picture.h"

namespace standoff::fly {

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

/// See-through walls, which are prepared once; the bodies with the shells of their fields, and their paths in the
/// colors of the distance to the nearest wall; a magenta ring where one has just touched a wall, a star where one
/// passed through; and how many steps, contacts and crossings there were.
class FlightPictures {
 public:
  /// Subject and frames must outlive it. `options`: shadows and axes are not drawn. Errors: as write_picture; usage (no
  /// frames).
  FlightPictures(const FlightSubject& subject, std::span<const FlightFrame> frames, double frames_per_second,
                 const PictureOptions& options);

  std::size_t count() const { return frames_.size(); }
  /// The picture of the next frame; the first call gives that of the first. The same pixels for any number of threads.
  Image next();

 private:
  Drawing moving(const FlightFrame& frame);
  void write_words(const FlightFrame& frame, Image& image) const;

  const FlightSubject& subject_;
  std::span<const FlightFrame> frames_;
  PictureOptions options_;
  Threads threads_;
  Camera camera_;
  Stage stage_;
  Stage::Extent extent_;
  Trails trails_;
  std::size_t next_ = 0;

  // What moves in the picture that is drawn: a drawing views it.
  struct Bodies {
    Mesh flies, shells;
    std::vector<double> distances;  // of the shells' vertices
  };
  Bodies calm_, touching_;
  std::vector<Vec3> path_, rings_, stars_;
  std::vector<double> path_distances_;
  std::vector<std::size_t> path_starts_, ring_starts_, star_starts_;
};

}  // namespace standoff::fly
