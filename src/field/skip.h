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
  /// Gets a valid mesh, a grid, the thickness and SkipRule::fraction. Returns the triangles that stay, ascending; at
  /// least one of a mesh that has any. Uses the caller's arena.
  std::vector<std::uint32_t> (*kept)(MeshView, const Grid&, double thickness, double fraction);
  std::int64_t bytes_per_triangle;  ///< that it may need, its result included
};

/// Null for the kinds that keep every triangle: none, and automatic.
const SkipRow* find_skip_rule(SkipRule::Kind kind);

/// The triangles that stay by a rule, of whatever kind. As SkipRow::kept.
std::vector<std::uint32_t> kept_triangles(MeshView mesh, const Grid& grid, double thickness, SkipRule rule);

/// Bytes that kept_triangles may need, its result included.
std::int64_t skip_bytes(std::int64_t triangles, SkipRule rule);

// The rule `exact`.

/// Drops what changes no bit of any sample and of no nearest triangle: copies, whose corners equal those of a triangle
/// before them one by one, and triangles whose box, grown by the thickness and room for rounding, holds no sample of
/// the grid. Keeps at least one triangle. Sorts 8 bytes per triangle by hash, on all threads of the caller's arena.
/// Requires a valid mesh.
std::vector<std::uint32_t> kept_by_exact_rule(MeshView mesh, const Grid& grid, double thickness);

/// Bytes per triangle that the rule may need: the result, a hash, an entry to sort, a flag, and 8 KiB of counters per
/// 2^14 triangles.
inline constexpr std::int64_t kExactRuleBytes = 18;

// Without a rule: meshes with very many copies of triangles, as scenes that place a part again and again where it is.
// All copies are equally near, so every sample would look at every one of them.

/// Whether a triangle taken at random has other copies, at least about a quarter of one on average. A copy has the same
/// corners one by one, bit by bit. Looks at some 8 sqrt(n) of n triangles, so it costs next to nothing; the answer for
/// a mesh is always the same. `among`: ascending numbers of triangles; all if it is empty. Requires a valid mesh.
bool has_many_copies(MeshView mesh, std::span<const std::uint32_t> among = {});

/// If has_many_copies(): the triangles without the copies of ones before them, ascending, but for a few copies where
/// many triangles have one hash. They have the same distances, and of equally near triangles the same lowest number.
/// Empty if all of `among` stay. Takes 5.125 bytes per triangle at the most, for a table or for the result, which is
/// less than any work on them does. Throws Error{interrupted}.
std::vector<std::uint32_t> without_many_copies(MeshView mesh, std::span<const std::uint32_t> among,
                                               ProgressMeter& progress);

}  // namespace standoff
