// SPDX-License-Identifier: Apache-2.0
// The search for one pair of triangles that intersect, with which several queries begin.
#pragma once

#include <cstdint>
#include <optional>

#include "collision/query_pair.h"

namespace standoff::collision {

/// Two triangles by their BVH indices.
struct IntersectingPair {
  std::uint32_t of_target, of_probe;
};

/// A pair of triangles that intersect or are within the margin; nothing where there is none.
std::optional<IntersectingPair> find_intersecting_pair(const QueryPair& pair, double margin);

}  // namespace standoff::collision
