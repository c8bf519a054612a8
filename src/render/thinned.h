// SPDX-License-Identifier: Apache-2.0
// A mesh with fewer triangles that is as good from afar.
#pragma once

#include <span>
#include <vector>

#include "render/float3.h"
#include "standoff/mesh_view.h"

namespace standoff {

/// The triangles without those that are smaller than `size` and have another such triangle near: of those whose first
/// corners lie in the same cube with sides of `size`, the first is kept. So every point of the mesh is within
/// (1 + sqrt(3)) * size of what is left. `size` must not be less than 2^-10; places are in the unit space.
std::vector<Triangle> thinned(std::span<const Float3> places, TriangleArray triangles, float size);

}  // namespace standoff
