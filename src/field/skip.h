// SPDX-License-Identifier: Apache-2.0
// Which triangles may be left out before any distance is computed (docs/skip.md). Each skip rule is one function, and a
// row of the table in src/backends/fields.cpp.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/progress.h"
#include "standoff/compute.h"
#include "standoff/grid.h"
#include "standoff/mesh.h"

namespace standoff {

/// A rule that drops triangles.
struct SkipRow {
  SkipRule::Kind kind;
  /// Takes a valid mesh, a grid, the thickness and SkipRule::fraction. Returns the triangles that stay, ascending: at
  /// least one, unless the mesh has none. Uses the caller's arena.
  std::vector<std::uint32_t> (*kept)(MeshView, const Grid&, double thickness, double fraction);
  std::int64_t bytes_per_triangle;  ///< memory that it may need, its result included
};

/// Null for the kinds that keep every triangle: none, and automatic.
const SkipRow* find_skip_rule(SkipRule::Kind kind);

/// The triangles that stay by a rule of any kind; otherwise like SkipRow::kept.
std::vector<std::uint32_t> kept_triangles(MeshView mesh, const Grid& grid, double thickness, SkipRule rule);

/// Bytes that kept_triangles may need, its result included.
std::int64_t skip_bytes(std::int64_t triangles, SkipRule rule);

/// The rule `exact`. Drops triangles that change no bit of any sample or nearest triangle: copies, whose corners equal
/// the corners of an earlier triangle one by one; and triangles whose box, grown by the thickness and room for
/// rounding, holds no sample of the grid. Keeps at least one triangle. Sorts 8 bytes per triangle by hash, on all
/// threads of the caller's arena. Requires a valid mesh.
std::vector<std::uint32_t> kept_by_exact_rule(MeshView mesh, const Grid& grid, double thickness);

/// Bytes per triangle that the rule may need: the result, a hash, an entry to sort, a flag, and 8 KiB of counters per
/// 2^14 triangles.
inline constexpr std::int64_t kExactRuleBytes = 18;

// Without a rule, only very many copies of triangles are dropped: some scenes place a part again and again in one
// place. All copies are equally near, so every sample would measure every one of them.

/// Whether a triangle has at least about a quarter of another copy on average. A copy has the same corners one by one,
/// bit by bit. Tests some 8 sqrt(n) of n triangles, so it costs next to nothing; the answer for a mesh is always the
/// same. `among`: ascending triangles; all if it is empty. Requires a valid mesh.
bool has_many_copies(MeshView mesh, std::span<const std::uint32_t> among = {});

/// If has_many_copies(): the triangles that are no copies of earlier ones, ascending. A few copies may stay if many
/// triangles have one hash. Distances and nearest triangles do not change, as the lowest index wins a tie. Empty if all
/// of `among` stay. Takes at most 5.125 bytes per triangle, for a table or for the result, which is less than any work
/// on the triangles takes. Throws Error{interrupted}.
std::vector<std::uint32_t> without_many_copies(MeshView mesh, std::span<const std::uint32_t> among,
                                               ProgressMeter& progress);

}  // namespace standoff
