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
  std::int64_t pairs, tests;  ///< the search stops soon after it has found, or done, as many
  double from = 0, to = 1;    ///< the part of the whole work, for the progress
};

/// Counts pairs of triangles that have a point in common, exactly, though they share no position. Copies of a triangle
/// share all of theirs: they do not intersect each other, and each of them intersects what one does.
///
/// The search goes through the triangles in groups and stops after the group in which a limit is reached. Tests are
/// pairs with overlapping boxes; where very many boxes are compared to find them, or share a position and need no test,
/// that counts as some tests. Of a triangle whose box overlaps very many others only the first ones are looked at. So
/// the time is bounded whatever the mesh is, and the result does not depend on the threads. Requires a valid mesh and
/// its edges. Runs on the threads of the calling TBB arena. Throws Error{interrupted}.
SelfIntersections find_self_intersections(MeshView mesh, const MeshEdges& edges, const IntersectionLimits& limits,
                                          ProgressMeter& progress);

}  // namespace standoff
