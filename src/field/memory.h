// How much memory a computation may need, before it starts.
#pragma once

#include "standoff/compute.h"

namespace standoff {

/// Throws Error{limit} where the computation may need more than options.memory_limit, with what would fit. Looks at the
/// triangles only if no bound without them is small enough. Errors: input (mesh) and limit (mesh) if it looks.
void check_memory(MeshView mesh, const Grid& grid, double thickness, const ComputeOptions& options, bool dense);

}  // namespace standoff
