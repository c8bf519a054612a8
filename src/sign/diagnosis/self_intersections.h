// SPDX-License-Identifier: Apache-2.0
// Triangles of a mesh that intersect each other.
#pragma once

#include <cstdint>

#include "sign/diagnosis/mesh_edges.h"
#include "standoff/mesh.h"

namespace standoff {

struct SelfIntersections {
  std::int64_t pairs = 0;
  bool complete = true;  ///< false: the search was stopped, and there may be more
};

/// Counts pairs of triangles that have a point in common, exactly, though they share no position. The search goes
/// through the triangles in groups and stops after the group in which `most_pairs` or `most_tests` is reached; tests
/// are pairs with overlapping boxes. Of a triangle whose box overlaps very many others only the first ones are tested.
/// So the time is bounded, and the result does not depend on the threads. Requires a valid mesh and its edges. Runs on
/// the threads of the calling TBB arena.
SelfIntersections find_self_intersections(MeshView mesh, const MeshEdges& edges, std::int64_t most_pairs,
                                          std::int64_t most_tests);

}  // namespace standoff
