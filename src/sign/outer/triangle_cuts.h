// SPDX-License-Identifier: Apache-2.0
// The triangles of a mesh that others cut or touch.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "bvh/bvh.h"
#include "core/progress.h"
#include "sign/oriented_mesh.h"

namespace standoff {

/// Pairs of triangles, sorted.
using TrianglePairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

/// The pairs whose first triangle is this one.
std::span<const std::pair<std::uint32_t, std::uint32_t>> pairs_of(const TrianglePairs& pairs, std::uint32_t triangle);

struct MeshCuts {
  std::vector<std::uint8_t> flat;  ///< for each triangle whether it has no area
  /// For each triangle whether one in use has points in its interior. Triangles in its plane do not count.
  std::vector<std::uint8_t> cut;
  TrianglePairs touched;  ///< a triangle without an area, and one with an area that touches it
};

/// Compares all pairs of triangles whose boxes overlap. Requires a valid mesh. Runs on the threads of the calling TBB
/// arena; the result does not depend on them. Throws Error{interrupted}.
MeshCuts find_cuts(const OrientedMesh& mesh, const Bvh& bvh, ProgressMeter& progress);

}  // namespace standoff
