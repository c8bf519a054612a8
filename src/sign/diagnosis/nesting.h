// SPDX-License-Identifier: Apache-2.0
// Which parts of a mesh lie inside which others.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "sign/oriented_mesh.h"

namespace standoff {

/// What is known of a part of a mesh.
struct Part {
  Box bounds;
  bool solid = false;  ///< whether it has an inside; all others are inside nothing and contain nothing
};

struct Nesting {
  static constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

  std::vector<std::int32_t> depth;    ///< for each part, how many others contain it
  std::vector<std::uint32_t> parent;  ///< the one of those whose box has the least sum of sides; kNone: none
  bool known = true;                  ///< false if it would take more than kMostNestingTests: then all depths are 0
};

/// Pairs of a triangle and a point that are compared at the most: a second or two. Meshes of a million parts that all
/// overlap exceed it.
inline constexpr std::int64_t kMostNestingTests = 1'000'000'000;

/// A part is inside another one if its box is inside the other's box and the other's winding number is not 0 at most of
/// three of its points: on it within rounding, far from each other or on rows far from each other. Winding numbers are
/// counted along rows by exact predicates; of a part with holes they may be wrong where the row passes a hole. Requires
/// `part_of` for each triangle, and parts that are oriented consistently, inwards or outwards. Runs on the threads of
/// the calling TBB arena.
///
/// A row through an innermost part also asks the parts that it meets on its way, so nested shells take time like
/// sorting their triangles on the row, apart from the comparison of all boxes that overlap (a nanosecond a pair).
Nesting find_nesting(const OrientedMesh& mesh, std::span<const std::uint32_t> part_of, std::span<const Part> parts,
                     std::int64_t most_tests = kMostNestingTests);

}  // namespace standoff
