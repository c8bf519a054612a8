// SPDX-License-Identifier: Apache-2.0
// Winding numbers to check signs with. Slow and simple, and nothing of it comes from src/sign: other rays, other
// decisions on edges, and for open meshes no rays at all.
#pragma once

#include <cstdint>
#include <limits>

#include "field/triangle_groups.h"
#include "sign/oriented_mesh.h"

namespace standoff {

struct ReferenceWinding {
  double value = 0;
  double error = 0;         ///< the true one is no farther from `value`
  bool on_surface = false;  ///< the point is on a triangle, exactly: it has no side
};

/// The crossings of the ray from p along +y, counted exactly: the winding number where the mesh is closed. Where it is
/// closed but not oriented, the parity of the number is right. Takes a look at every 32nd triangle, and at those near
/// the ray. Requires the groups of the same mesh, and coordinates that are zero or of magnitude 1e-90 to 1e100.
ReferenceWinding winding_by_crossings(const OrientedMesh& mesh, const TriangleGroups& groups, const Vec3& p);

/// The sum of the triangles' solid angles over 4 pi (van Oosterom and Strackee 1983): the generalised winding number,
/// of any mesh. Takes a look at every triangle. The error is infinite at a corner of a triangle.
ReferenceWinding winding_by_angles(const OrientedMesh& mesh, const Vec3& p);

}  // namespace standoff
