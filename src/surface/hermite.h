// SPDX-License-Identifier: Apache-2.0
// What dual contouring knows of the surface on a crossed edge of the grid: where it is, and its normal.
#pragma once

#include <span>
#include <vector>

#include "core/progress.h"
#include "standoff/mesh.h"
#include "surface/blocks.h"
#include "surface/edge_points.h"

namespace standoff {

struct HermitePoint {
  float t = 0.5f;                 ///< from the lower end, in spacings of the edge's axis
  float x = 0, y = 0, z = 0;      ///< the unit normal, outwards

  Vec3 normal() const { return {x, y, z}; }
  void set_normal(Vec3 n) {
    x = static_cast<float>(n.x);
    y = static_cast<float>(n.y);
    z = static_cast<float>(n.z);
  }
};

/// From the field alone: interpolated, with the normal of central differences. `data` has an entry for each crossed
/// edge, by Block::vertex(). Runs on the threads of the calling TBB arena. Throws Error{interrupted}.
void hermite_of_field(const Blocks& blocks, const EdgePoints& points, std::span<HermitePoint> data,
                      ProgressMeter& progress);

}  // namespace standoff
