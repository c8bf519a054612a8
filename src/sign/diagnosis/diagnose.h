// SPDX-License-Identifier: Apache-2.0
// What must be known of a mesh to choose a sign method, and what the methods need of it.
#pragma once

#include "core/progress.h"
#include "sign/diagnosis/boundary.h"
#include "sign/diagnosis/mesh_edges.h"
#include "sign/diagnosis/orient.h"
#include "standoff/mesh_report.h"

namespace standoff {

struct Diagnosis {
  Orientation orientation;
  Boundary boundary;  ///< of the mesh in that orientation
  /// Without components, their nesting, and intersections.
  MeshReport report;
};

/// Requires a valid mesh and its edges. `progress` is checked between steps. Runs on the threads of the calling TBB
/// arena.
Diagnosis diagnose(MeshView mesh, const MeshEdges& edges, ProgressMeter& progress);

}  // namespace standoff
