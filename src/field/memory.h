// SPDX-License-Identifier: Apache-2.0
// How much memory a computation may need, before it starts.
#pragma once

#include "field/plan.h"

namespace standoff {

/// Output and scratch, where so many tiles hold band samples; dense output takes no notice of them. `diagnosed`:
/// whether the mesh is diagnosed before, for its sign. At most 2^62.
std::int64_t bytes_needed(const Plan& plan, double tiles, bool diagnosed);
/// The same for whatever triangles: all tiles of the grid.
std::int64_t bytes_needed(const Plan& plan);
/// The same for these triangles. Uses the caller's arena. Errors: as validate(mesh).
std::int64_t bytes_needed(MeshView mesh, const Plan& plan, const ComputeOptions& options);

/// What crossings may take while the sign is decided: of a whole grid what the backend took before, if that is enough.
std::int64_t crossing_bytes(const Plan& plan);

/// Throws Error{limit} where the computation may need more than
/// options.memory_limit, with what would fit. `tiles`: those that the mesh's triangles reach (prepare.h). Requires a
/// valid mesh.
void check_memory(MeshView mesh, const Plan& plan, double tiles, const ComputeOptions& options);

}  // namespace standoff
