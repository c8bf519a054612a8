// SPDX-License-Identifier: Apache-2.0
// The step before the backend: validates the mesh, checks memory and the range of float, applies the skip rule.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "field/plan.h"

namespace standoff {

/// What one pass over a mesh finds out.
struct MeshLook {
  /// Float holds the distances of all vertices (float_range.h). Where not, those that matter may still be near enough.
  bool is_near;
  /// Tiles that hold samples of some triangle's box grown by the thickness, at most; 0 where they were not counted.
  double tiles;
};

/// Goes over the vertices once and over the triangles once, in memory's order. Uses the caller's arena. Errors: as
/// validate(mesh).
MeshLook look_at(MeshView mesh, const Plan& plan, bool counts_tiles);

/// Throws as validate(mesh) does; Error{limit} where the computation may need more than options.memory_limit, with what
/// would fit, and as check_domain(mesh, grid) does. Looks at the mesh once. Uses the caller's arena.
void check_mesh(MeshView mesh, const Plan& plan, const ComputeOptions& options);

/// Of the triangles in `among`, which are all if it is empty, those that the plan's skip rule keeps, ascending; empty
/// when all of the mesh. The rule sees no others. Where there is no rule, copies of triangles are left out if they are
/// many and the plan says so, and that takes no more memory than all triangles would. Requires a checked mesh. Throws
/// Error{interrupted}.
std::vector<std::uint32_t> kept_by_plan(MeshView mesh, const Plan& plan, std::span<const std::uint32_t> among,
                                        ProgressMeter& progress);

}  // namespace standoff
