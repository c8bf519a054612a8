// SPDX-License-Identifier: Apache-2.0
// The connected parts of a surface.
#pragma once

#include <cstdint>
#include <vector>

#include "core/progress.h"
#include "standoff/mesh.h"

namespace standoff::collision {

/// The lowest index of a triangle of each connected component, in ascending order. Triangles are connected if they have
/// a corner at the same position, so a mesh need not be welded. Requires a valid mesh. The progress can end it.
std::vector<std::uint32_t> first_of_components(MeshView mesh, ProgressMeter& progress);

}  // namespace standoff::collision
