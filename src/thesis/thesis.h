// SPDX-License-Identifier: Apache-2.0
// What src/thesis gives to the tables in src/backends.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "field/backend.h"
#include "standoff/mesh.h"

namespace standoff::cpu {

// The method `thesis` on the CPU: Algorithm 1 of the 2008 thesis (docs/thesis.md).

/// For each triangle, for each sample in its box grown by the thickness: the squared distance, kept where it is
/// smaller. Counts::samples_examined is the number of these pairs. Skipping and compaction come before (Job::kept).
Counts run_thesis(const Job& job, Sink& sink);
std::string thesis_device(Simd requested);
std::int64_t thesis_scratch_bytes(std::int64_t triangles, const Grid& grid, double thickness, int threads);

}  // namespace standoff::cpu

namespace standoff {

// The thesis's skip rule, `neighbour` (docs/skip.md).

/// Goes through the mesh in order and drops a triangle when at least `fraction` of its box, grown by `thickness` on all
/// sides, lies in that of its neighbour, the nearest triangle before or after it that has not been dropped; of two
/// equal ones the later. It ends where no triangle that stays could be dropped. Fraction 1 compares boxes without
/// tolerance, grown or not. With infinite thickness the boxes are not grown. Linear in the number of triangles, one
/// thread; memory for the result alone. Requires a valid mesh.
std::vector<std::uint32_t> kept_by_neighbour_rule(MeshView mesh, double thickness, double fraction);

/// The share of `inner`, grown by `margin`, that lies in `outer` grown alike: 0 to 1, and 1 exactly when all of it does
/// and the boxes are not so far apart in size that rounding hides the difference. Flat boxes count as the limit of thin
/// ones.
double share_inside(const Box& inner, const Box& outer, double margin);

}  // namespace standoff
