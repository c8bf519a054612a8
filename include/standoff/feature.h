// SPDX-License-Identifier: Apache-2.0
// The parts of a triangle: its face, its edges and its vertices.
#pragma once

#include <cstdint>

namespace standoff {

/// The part of a triangle that a point of it lies on. Edge n runs from corner n to the next corner.
enum class Feature : std::uint8_t { face, edge0, edge1, edge2, vertex0, vertex1, vertex2 };

}  // namespace standoff
