// SPDX-License-Identifier: Apache-2.0
// The samples of a field in one plane.
#pragma once

#include <cstdint>
#include <vector>

#include "standoff/slice.h"

namespace standoff {

struct Plane {
  char normal = 'z', right = 'x', up = 'y';  ///< names of axes
  std::int64_t width = 0, height = 0;        ///< samples to the right and up
  double first_right = 0, first_up = 0;      ///< where the lower left sample is, world units
  double step_right = 1, step_up = 1;        ///< distances between samples, world units
  std::int64_t index = 0, count = 0;         ///< which sample along the normal, of how many
  double position = 0;                       ///< its coordinate, world units
  std::vector<float> values;                 ///< rightwards first, then upwards

  float value(std::int64_t r, std::int64_t u) const { return values[static_cast<std::size_t>(r + width * u)]; }
};

/// The samples of the plane that slice_plane() chooses. Errors: as there.
Plane plane_of(const DistanceField& field, const SliceOptions& options);

}  // namespace standoff
