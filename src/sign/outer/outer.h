// SPDX-License-Identifier: Apache-2.0
// SignOptions::outer: internal triangles are left out before distances are computed.
#pragma once

#include "sign/plan.h"

namespace standoff {

/// Finds the triangles that are exposed by this plan. Throws Error{input} where the plan is not that of a closed mesh's
/// winding number, Error{interrupted}. Requires a valid mesh. Runs on the threads of the calling TBB arena.
void plan_outer(MeshView mesh, const SignOptions& options, SignPlan& plan, ProgressMeter& progress);

}  // namespace standoff
