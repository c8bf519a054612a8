// SPDX-License-Identifier: Apache-2.0
// One surface of a field, by either method.
#pragma once

#include "core/progress.h"
#include "standoff/surface.h"
#include "surface/dual_contouring.h"

namespace standoff {

/// Throws Error{usage} for options that make no sense on this grid.
void validate(const IsoOptions& options, const Grid& grid);

/// Adds the surface at options.at, and that at options.at - options.wall if there is a wall. `source_of` gives the
/// source of normals for each level. The steps are reported between `from` and 1 of the whole. Runs on the threads of
/// the calling TBB arena.
void extract(const DistanceField& field, const IsoOptions& options,
             const std::function<HermiteSource(double level)>& source_of, double from, MemoryBudget& budget,
             IsoResult& result, ProgressMeter& progress);

/// The source for a field of which nothing else is known.
HermiteSource field_source();

/// Counts what the report says of the result.
void finish(const IsoOptions& options, IsoResult& result);

}  // namespace standoff
