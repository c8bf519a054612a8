// SPDX-License-Identifier: Apache-2.0
// Meshes with fewer triangles, for drawing: by meshoptimizer.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "standoff/mesh_view.h"

namespace standoff::page {

/// Whether this build can simplify.
bool can_simplify();

/// At most `most` triangles over the same vertices that look like the given ones; `most` is less than there are. The
/// vertices are any three floats each. Empty where this build cannot simplify.
std::vector<Triangle> simplified(std::span<const Triangle> triangles, std::span<const float> vertices,
                                 std::size_t most);

}  // namespace standoff::page
