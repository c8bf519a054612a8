// SPDX-License-Identifier: Apache-2.0
// Which of two algorithms takes a band: sorting triangles straight into the bricks that they reach (bins.h), or handing
// candidates down from coarse cells (candidate_culling.h). Both give the same field.
#pragma once

#include <algorithm>

#include "field/backend.h"
#include "field/tolerances.h"

namespace standoff::cpu {

enum class BandAlgorithm { bins, descent };

/// What needs no look at the triangles: up to the first thickness, in the smallest spacings, bins are always faster;
/// beyond the second one, in the largest spacings, their lists would be long.
inline constexpr double kAlwaysBins = 2.5, kNeverBins = 16;
static_assert(kNeverBins <= kLeastSpeckBand, "bins know no specks");
inline bool may_take_bins(const Grid& grid, double thickness) { return thickness <= kNeverBins * grid.max_spacing(); }
inline bool may_take_descent(const Grid& grid, double thickness) {
  const Vec3& h = grid.spacing;
  return thickness > kAlwaysBins * std::min({h.x, h.y, h.z});
}

/// The algorithm that takes less time for the job, by counts of what each would do for some of its triangles.
BandAlgorithm band_algorithm(const Job& job);

}  // namespace standoff::cpu
