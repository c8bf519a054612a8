// SPDX-License-Identifier: Apache-2.0
// Marching cubes: the triangles of each cell, with vertices on the edges of the grid (docs/iso.md).
#pragma once

#include "core/progress.h"
#include "standoff/surface.h"
#include "surface/blocks.h"
#include "surface/edge_points.h"

namespace standoff {

/// Adds to the mesh's vertices and triangles, and to the report's ambiguous faces, clamped and capped edges. Numbers
/// the vertices of the blocks. `memory` is for scratch, its budget for the mesh. Runs on the threads of the calling TBB
/// arena. Throws Error{limit}, Error{interrupted}.
void march_cubes(Blocks& blocks, const EdgePoints& points, MemoryShare& memory, Mesh& mesh, IsoReport& report,
                 ProgressMeter& progress);

}  // namespace standoff
