// SPDX-License-Identifier: Apache-2.0
// Whether a closed mesh needs no turning: the quick answer for most meshes, before orient() looks closely.
#pragma once

#include <cstdint>

#include "standoff/mesh.h"

namespace standoff {

/// True only if each set of triangles that share vertices, by index, has normals that cancel, as those of a closed set
/// do, and a positive volume: then no part of a closed mesh is inside out. Sets without area do not count, but some
/// must have one. Does not depend on the number of threads. Requires a valid mesh. Runs on the threads of the calling
/// TBB arena.
bool faces_outwards(MeshView mesh);
/// What that holds at most, for a mesh without vertices that no triangle uses.
std::int64_t outward_bytes(std::int64_t triangles);

}  // namespace standoff
