// SPDX-License-Identifier: Apache-2.0
// The thesis's skip rule, `neighbour` (docs/skip.md).
#pragma once

#include <cstdint>
#include <vector>

#include "standoff/mesh.h"

namespace standoff {

/// Goes through the mesh in order and drops a triangle when at least `fraction` of its box, grown by `thickness` on all
/// sides, lies in that of its neighbour, the nearest triangle before or after it that has not been dropped; of two
/// equal ones the later. It ends where no triangle that stays could be dropped. Fraction 1 compares boxes without
/// tolerance, grown or not. With infinite thickness the boxes are not grown. Linear in the number of triangles, one
/// thread; memory for the result alone. Requires a valid mesh.
std::vector<std::uint32_t> kept_by_neighbour_rule(MeshView mesh, double thickness, double fraction);

/// The share of `inner`, grown by `margin`, that lies in `outer` grown alike: 0 to 1, and 1 exactly when all of it does
/// and the boxes are not so far apart in size that rounding hides the difference. Flat boxes count as the limit of thin
/// ones.
double share_inside(const Box& inner, const Box& outer, double margin);

}  // namespace standoff
