// SPDX-License-Identifier: Apache-2.0
// Dual contouring: vertices in the cells, polygons around the crossed edges of the grid (docs/iso.md).
#pragma once

#include <functional>
#include <span>

#include "core/progress.h"
#include "standoff/surface.h"
#include "surface/blocks.h"
#include "surface/edge_points.h"
#include "surface/hermite.h"

namespace standoff {

/// How positions and normals are found, and how far they are to be trusted.
struct HermiteSource {
  std::function<void(const Blocks&, const EdgePoints&, std::span<HermitePoint>, MemoryBudget&, ProgressMeter&)> fill;
  double tolerance;  ///< PlaneFit::minimum
};

/// Adds to the mesh and to the report, as march_cubes() does.
void contour_dually(Blocks& blocks, const EdgePoints& points, const HermiteSource& source, MemoryShare& memory,
                    Mesh& mesh, IsoReport& report, ProgressMeter& progress);

}  // namespace standoff
