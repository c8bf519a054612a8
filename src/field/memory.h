// How much memory a computation may need, before it starts.
#pragma once

#include <string>

#include "standoff/compute.h"

namespace standoff {

/// Bytes that a DistanceField takes with so many tiles stored, of so many in its grid.
double field_bytes(double stored_tiles, double all_tiles, bool with_nearest);

/// "161 MiB, more than the limit of 160 MiB": requires needed > limit, and shows it.
std::string over_the_limit(double needed, double limit);

/// Throws Error{limit} where the computation may need more than options.memory_limit, with what would fit. Looks at the
/// triangles only if no bound without them is small enough. Errors: input (mesh) and limit (mesh) if it looks.
void check_memory(MeshView mesh, const Grid& grid, const Options& options, bool dense);

}  // namespace standoff
