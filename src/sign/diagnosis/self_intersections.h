// SPDX-License-Identifier: Apache-2.0
// Triangles of a mesh that intersect each other.
#pragma once

#include <cstdint>

#include "core/progress.h"
#include "sign/diagnosis/mesh_edges.h"
#include "standoff/mesh.h"

namespace standoff {

struct SelfIntersections {
  std::int64_t pairs = 0;
  bool complete = true;  ///< false: the search was stopped, and there may be more
};

struct IntersectionLimits {
  std::int64_t pairs, tests;  ///< the search stops soon after it has found this many pairs, or done this many tests
  double from = 0, to = 1;    ///< the part of the whole work, for the progress
};

/// Counts pairs of triangles that have a point in common, exactly, though they share no position. Copies of a triangle
/// share all their positions: they do not intersect each other, and each intersects the same triangles.
///
/// The search goes through the triangles in groups and stops after the group in which a limit is reached. A test
/// compares a pair with overlapping boxes. Very many compared boxes count as some tests, and so do pairs that share a
/// position and need no test. If a triangle's box overlaps very many others, only the first ones are compared. So the
/// time is bounded whatever the mesh is, and the result does not depend on the threads. Requires a valid mesh and its
/// edges. Runs on the threads of the calling TBB arena. Throws Error{interrupted}.
SelfIntersections find_self_intersections(MeshView mesh, const MeshEdges& edges, const IntersectionLimits& limits,
                                          ProgressMeter& progress);

}  // namespace standoff
