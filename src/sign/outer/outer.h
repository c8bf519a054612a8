// SPDX-License-Identifier: Apache-2.0
// SignOptions::outer: internal triangles, which have inside on both sides, are left out before distances are computed
// (docs/outer.md). Without them a field is the field of the union of all parts.
#pragma once

#include <cstdint>
#include <vector>

#include "core/progress.h"
#include "sign/oriented_mesh.h"
#include "sign/plan.h"
#include "standoff/exposed.h"

namespace standoff {

struct Exposures {
  std::vector<Exposure> of;  ///< for each triangle
  std::int64_t internal = 0, cut = 0;
};

/// Requires a valid mesh that is closed in that orientation. Runs on the threads of the calling TBB arena. Throws
/// Error{interrupted}.
Exposures find_exposed(const OrientedMesh& mesh, WindingRule rule, ProgressMeter& progress);

/// Puts the exposed triangles into the plan. Throws Error{input} unless the plan decides by the winding number of a
/// closed mesh, and Error{interrupted}. Requires a valid mesh. Runs on the threads of the calling TBB arena.
void plan_outer(MeshView mesh, const SignOptions& options, SignPlan& plan, ProgressMeter& progress);

}  // namespace standoff
