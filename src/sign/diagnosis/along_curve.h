// SPDX-License-Identifier: Apache-2.0
// The triangles of a mesh along a space-filling curve, so that those that follow each other are near each other.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "standoff/mesh.h"

namespace standoff {

/// All triangles, by the Morton number of the cell that holds the middle of their box, then by index: 2^10 cells along
/// the longest side of the mesh. In order of their indices if that side is 0, or too long or too short for doubles.
/// Requires a valid mesh. Takes 12 bytes for each triangle. Runs on the threads of the calling TBB arena.
std::vector<std::uint32_t> along_curve(MeshView mesh);

}  // namespace standoff
