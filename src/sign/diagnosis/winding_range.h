// SPDX-License-Identifier: Apache-2.0
// Which winding numbers occur.
#pragma once

#include <cstdint>

#include "sign/oriented_mesh.h"

namespace standoff {

struct WindingRange {
  std::int32_t least = 0, most = 0;
};

/// The least and the largest winding number at 1024 samples of each of 128 x 128 rows along x through the bounds, or of
/// fewer rows where triangles cover many of them. Exact there; what lies between the samples is not seen. Requires a
/// mesh that is closed in the orientation given. Runs on the threads of the calling TBB arena.
WindingRange find_winding_range(const OrientedMesh& mesh, const Box& bounds);

}  // namespace standoff
