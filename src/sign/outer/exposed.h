// SPDX-License-Identifier: Apache-2.0
// Triangles with inside on both sides (docs/outer.md). Without them a field is that of the union of all parts.
#pragma once

#include <cstdint>
#include <vector>

#include "core/progress.h"
#include "sign/oriented_mesh.h"
#include "standoff/exposed.h"

namespace standoff {

struct Exposures {
  std::vector<Exposure> of;  ///< for each triangle
  std::int64_t internal = 0, cut = 0;
};

/// Requires a valid mesh that is closed in that orientation. Runs on the threads of the calling TBB arena. Throws
/// Error{interrupted}.
Exposures find_exposed(const OrientedMesh& mesh, WindingRule rule, ProgressMeter& progress);

}  // namespace standoff
