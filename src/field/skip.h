// SPDX-License-Identifier: Apache-2.0
// Skip rules: which triangles may be left out before any distance is computed (docs/skip.md). Each rule is one function
// here and one file; to change a rule or add one, start from kept_triangles.
#pragma once

#include <cstdint>
#include <vector>

#include "standoff/compute.h"

namespace standoff {

/// The triangles that stay, ascending; at least one of a mesh that has any. The mesh must be valid, and grown boxes are
/// the triangles' boxes grown by `thickness` on all sides. Kind::none and Kind::automatic keep every triangle. Uses the
/// caller's arena.
std::vector<std::uint32_t> kept_triangles(MeshView mesh, const Grid& grid, double thickness, SkipRule rule);

/// Bytes that kept_triangles may need, its result included.
std::int64_t skip_bytes(std::int64_t triangles, SkipRule rule);

/// The thesis's rule: goes through the mesh in order and drops a triangle when at least `fraction` of its grown box
/// lies in that of its neighbour, the nearest triangle before or after it that has not been dropped; of two equal ones
/// the later. It ends where no triangle that stays could be dropped. Fraction 1 compares boxes without tolerance, grown
/// or not. With infinite thickness the boxes are not grown. Linear in the number of triangles, one thread.
std::vector<std::uint32_t> kept_by_neighbour_rule(MeshView mesh, double thickness, double fraction);

/// The share of `inner`, grown by `margin`, that lies in `outer` grown alike: 0 to 1, and 1 exactly when all of it does
/// and the boxes are not so far apart in size that rounding hides the difference. Flat boxes count as the limit of thin
/// ones.
double share_inside(const Box& inner, const Box& outer, double margin);

/// Drops what changes no bit of any sample and of no nearest triangle: copies, whose corners equal those of a triangle
/// before them one by one, and triangles whose grown box, with room for rounding, holds no sample of the grid.
/// Sorts 8 bytes per triangle by hash, on all threads of the caller's arena.
std::vector<std::uint32_t> kept_by_exact_rule(MeshView mesh, const Grid& grid, double thickness);

}  // namespace standoff
