// SPDX-License-Identifier: Apache-2.0
// Finds out which sign method fits a mesh, and what the methods need: its orientation and its boundary.
#pragma once

#include <cstdint>
#include <string>

#include "core/progress.h"
#include "sign/diagnosis/boundary.h"
#include "sign/diagnosis/mesh_edges.h"
#include "sign/diagnosis/orient.h"
#include "standoff/mesh_report.h"

namespace standoff {

struct Diagnosis {
  Orientation orientation;
  Boundary boundary;  ///< of the mesh in that orientation
  MeshReport report;  ///< without components, their nesting, and intersections
};

/// Requires a valid mesh and its edges. `progress` is checked between steps. Runs on the threads of the calling TBB
/// arena.
Diagnosis diagnose(MeshView mesh, const MeshEdges& edges, ProgressMeter& progress);

/// The most bytes that diagnose() takes to find the winding numbers that occur in a mesh that is closed once it is
/// oriented; for the mesh, or for any of so many triangles.
std::int64_t winding_range_bytes(MeshView mesh, int threads);
std::int64_t winding_range_bytes(std::int64_t triangles, int threads);

/// A number with a noun, such as "1 edge" or "2 edges".
std::string counted(std::int64_t n, const char* one, const char* many);

}  // namespace standoff
