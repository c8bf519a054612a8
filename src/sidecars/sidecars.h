// SPDX-License-Identifier: Apache-2.0
// What the CPU's and the GPU's sidecars share outside of tiles: the scale of coordinates, and the orientation that
// normals on the surface follow.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "sign/sign_text.h"
#include "standoff/grid.h"
#include "standoff/mesh_view.h"

namespace standoff {

/// The power of two by which coordinates are multiplied, so that lengths are moderate.
inline double sidecar_scale(const Grid& grid) { return std::ldexp(1.0, -std::ilogb(grid.max_spacing())); }

/// The orientation of each triangle that a sign was decided with (OrientedMesh::use); empty if it is the mesh's own.
std::vector<std::int8_t> orientation_of(MeshView mesh, const SignText& sign);

}  // namespace standoff
