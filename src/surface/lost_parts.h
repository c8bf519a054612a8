// SPDX-License-Identifier: Apache-2.0
// What of a mesh its surface shows nothing of, because no sample is inside there.
#pragma once

#include "core/memory.h"
#include "core/progress.h"
#include "standoff/surface.h"

namespace standoff {

/// A point of the mesh is lost if none of the samples around it, those of its cell and of the 26 cells around that, is
/// less than the level: then the surface is farther than a spacing away, and the point is outside. (A point with all
/// samples inside, of a part within another one, is not lost.) Points beyond the grid do not count.
///
/// Sets the report's figures of lost parts, and their sentence. The share of the area is that of up to 2^14 points,
/// evenly spread over it; a part, triangles that share positions directly or through others, is lost if all points
/// are that were looked at: those, or a corner, and all corners and centres of up to 2^16 triangles in all. Linear in
/// the mesh; its result does not depend on the number of threads. Runs on the threads of the calling TBB arena.
void find_lost_parts(MeshView mesh, const DistanceField& field, double level, MemoryBudget& budget, IsoReport& report,
                     ProgressMeter& progress);

}  // namespace standoff
