// SPDX-License-Identifier: Apache-2.0
// What dual contouring knows of the surface on a crossed edge of the grid: where it is, and its normal.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "core/memory.h"
#include "core/progress.h"
#include "standoff/mesh.h"
#include "standoff/points.h"
#include "surface/blocks.h"
#include "surface/edge_points.h"

namespace standoff {

struct HermitePoint {
  float t = 0.5f;             ///< from the lower end, in spacings of the edge's axis
  float x = 0, y = 0, z = 0;  ///< the unit normal, outwards

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

/// The closest points of a mesh, without a sign.
using ClosestFunction = std::function<std::vector<ClosestPoint>(std::span<const Vec3>)>;

/// Points that are asked about together, and about what a question and its answer take besides.
inline constexpr std::size_t kAskedAtOnce = std::size_t{1} << 17, kBytesPerAsked = 256;

/// Of the surface of a mesh: the crossing with a triangle, exactly, and its normal. Where none is crossed, as in a hole
/// that the sign closes, the field's data stay.
void hermite_of_mesh(const Blocks& blocks, const EdgePoints& points, MeshView mesh, const ClosestFunction& closest,
                     std::span<HermitePoint> data, MemoryBudget& budget, ProgressMeter& progress);

/// A surface at a distance from a mesh.
struct MeshOffset {
  ClosestFunction closest;
  double distance = 0;  ///< positive
  bool inside = false;  ///< on the side where values are negative
};
/// Of that surface: where the exact distance is the offset's, and the direction to or from the closest point. Where no
/// such point is found on the edge the field's data stay.
void hermite_of_offset(const Blocks& blocks, const EdgePoints& points, const MeshOffset& offset,
                       std::span<HermitePoint> data, MemoryBudget& budget, ProgressMeter& progress);

}  // namespace standoff
