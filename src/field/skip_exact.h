// SPDX-License-Identifier: Apache-2.0
// The skip rule `exact` (docs/skip.md).
#pragma once

#include <cstdint>
#include <vector>

#include "standoff/grid.h"
#include "standoff/mesh.h"

namespace standoff {

/// Drops what changes no bit of any sample and of no nearest triangle: copies, whose corners equal those of a triangle
/// before them one by one, and triangles whose box, grown by the thickness and room for rounding, holds no sample of
/// the grid. Keeps at least one triangle. Sorts 8 bytes per triangle by hash, on all threads of the caller's arena.
/// Requires a valid mesh.
std::vector<std::uint32_t> kept_by_exact_rule(MeshView mesh, const Grid& grid, double thickness);

/// Bytes per triangle that the rule may need: the result, a hash, an entry to sort, a flag, and 8 KiB of counters per
/// 2^14 triangles.
inline constexpr std::int64_t kExactRuleBytes = 18;

}  // namespace standoff
