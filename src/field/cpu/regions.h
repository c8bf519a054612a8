// SPDX-License-Identifier: Apache-2.0
// Bands thicker than a few spacings by bins: beside and beyond a triangle whose neighbours are closed around it, these
// are nearer to a sample than it is. Finds how far its region reaches (docs/tiles.md, "Regions").
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "field/backend.h"
#include "field/lattice.h"

namespace standoff::cpu {

inline constexpr float kNoTilt = std::numeric_limits<float>::infinity();

/// Which samples a triangle may be nearest to.
struct Region {
  /// The tangent of the angle by which it widens with the height above the triangle, on both sides. Infinite where
  /// nothing is known of the neighbours: then these are all within the thickness.
  float tilt = kNoTilt;
  float reach[3] = {};  ///< how far beyond the triangle's box, grid units
};
using Regions = std::vector<Region>;  ///< by triangle of the mesh; empty if nothing is known of any

/// Larger tilts count as none: the regions would be as large as the boxes.
inline constexpr float kMostTilt = 2;

/// The sine of the smallest angle of a triangle next to a region; with a smaller one, there is none.
inline constexpr float kLeastSine = 0.25f;

/// The longest side of the box of such a triangle, grid units. Longer ones are measured less exactly.
inline constexpr float kLongestWithRegion = kLongTriangle / 2;

/// What bounds the regions is moved outwards by: as far as it takes to be worth that step. Grid units.
float region_slack(const Lattice& lattice);

/// A guess of the region of the job's n-th triangle, from this triangle and the next one alone.
Region guessed_region(const Job& job, const Lattice& lattice, std::int64_t n);

/// The regions of the job's triangles. Runs on the threads of the calling TBB arena. Throws Error{interrupted}.
Regions find_regions(const Job& job, const Lattice& lattice);

/// Bytes of a job's regions at most, and bytes that find_regions may hold at once, these included.
std::int64_t regions_bytes(std::int64_t triangles);
std::int64_t regions_scratch_bytes(std::int64_t triangles, int threads);

}  // namespace standoff::cpu
