// SPDX-License-Identifier: Apache-2.0
// A flight as pictures in memory.
#pragma once

#include <cstddef>
#include <span>

#include "core/threads.h"
#include "render/stage.h"
#include "standoff/picture.h"
#include "view/film/trails.h"
#include "view/flight/flight_page.h"

namespace standoff::view {

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

}  // namespace standoff::view
