// SPDX-License-Identifier: Apache-2.0
// Which plane of a field shows the most.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "standoff/field.h"

namespace standoff {

/// How much each plane of samples shows: for each axis, one number for each sample along it.
struct PlaneScores {
  std::array<std::vector<std::int64_t>, 3> along;
  std::array<double, 3> area{1, 1, 1};  ///< of one sample in the plane: along * area compares planes of different axes
};

/// Proportional to the length of the curve that each plane cuts out of the surface, weighted by the sine of the angle
/// between plane and surface: a face in the plane counts for nothing. It is counted in samples near the surface, each
/// with the share of its gradient that lies in the plane.
PlaneScores plane_scores(const DistanceField& field);

/// The plane to show among those of one axis, or -1 where none shows anything: the nearest to the middle of those that
/// do among all that show 90 % of the most.
std::int64_t best_plane(const std::vector<std::int64_t>& scores);

}  // namespace standoff
