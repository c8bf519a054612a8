// SPDX-License-Identifier: Apache-2.0
// A triangle in the plane, cut into convex cells along segments.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "geometry/predicates.h"

namespace standoff {

using FlatSegment = std::array<Flat, 2>;

/// A point in the middle of each cell. No segment passes through a cell, but for those that come no deeper into it than
/// `thin`: cells thinner than that may be left out. Nothing if there are more than `most` cells.
std::optional<std::vector<Flat>> cell_centres(const std::array<Flat, 3>& triangle,
                                              std::span<const FlatSegment> segments, double thin, std::size_t most);

}  // namespace standoff
