// SPDX-License-Identifier: Apache-2.0
// Skip rules: which triangles may be left out before any distance is computed (docs/skip.md). Each rule is one function
// in a file of its own, and a row of the table in src/backends/skip_rules.cpp.
#pragma once

#include <cstdint>
#include <vector>

#include "standoff/compute.h"

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

}  // namespace standoff
