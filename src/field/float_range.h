// How far apart mesh and grid may be.
#pragma once

#include "standoff/grid.h"
#include "standoff/mesh.h"

namespace standoff {

/// Backends compute squared distances in float, in units of the spacing. Throws Error{limit} where those, or the
/// distances in world units, would not be normal floats: the mesh reaches farther than 2^60 spacings or 2^125
/// units from the grid's centre, the largest spacing is not within 2^-110 and 2^100, or one is less than 2^-60 of
/// another. Requires a valid mesh and grid.
void check_domain(MeshView mesh, const Grid& grid);

}  // namespace standoff
