// SPDX-License-Identifier: Apache-2.0
// Which of two algorithms takes a band: sorting triangles straight into the bricks that they reach (bins.h), or handing
// candidates down from coarse cells (candidate_culling.h). Both give the same field.
#pragma once

#include <algorithm>
#include <cstdint>

#include "field/backend.h"
#include "field/cpu/regions.h"
#include "field/lattice.h"
#include "field/tolerances.h"

namespace standoff::cpu {

enum class BandAlgorithm { bins, descent };

/// Whether the bins of all bricks may be held at once: there are at most so many bricks, or one for each triangle. The
/// value is a choice: a grid of 1024 samples per axis has as many.
inline constexpr std::int64_t kMostBricksHeld = std::int64_t{1} << 18;
inline bool may_hold_bins(std::int64_t triangles, const Grid& grid) {
  return brick_count(grid) <= std::max(kMostBricksHeld, triangles);
}

/// What needs no look at the triangles. Bins take bands up to the first thickness, in the smallest spacings. They take
/// no band beyond the second one, in the largest spacings, and in between none of too many bricks.
inline constexpr double kAlwaysBins = 4, kNeverBins = 16;
static_assert(kNeverBins <= kLeastSpeckBand, "bins know no specks");
inline bool may_take_descent(const Grid& grid, double thickness) {
  const Vec3& h = grid.spacing;
  return thickness > kAlwaysBins * std::min({h.x, h.y, h.z});
}
inline bool may_take_bins(std::int64_t triangles, const Grid& grid, double thickness) {
  return !may_take_descent(grid, thickness) ||
         (thickness <= kNeverBins * grid.max_spacing() && may_hold_bins(triangles, grid));
}

/// The algorithm that takes less time for the job, by counts of what each would do for some of its triangles. Bins may
/// take less time with regions: then these are found.
struct BandChoice {
  BandAlgorithm algorithm;
  Regions regions;  ///< for bins; empty if they do without
};
BandChoice choose_band(const Job& job);

}  // namespace standoff::cpu
