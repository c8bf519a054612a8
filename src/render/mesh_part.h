// SPDX-License-Identifier: Apache-2.0
// Meshes as parts of a picture.
#pragma once

#include <vector>

#include "render/part.h"
#include "standoff/picture.h"

namespace standoff {

/// 1 for each vertex that no triangle of a valid mesh uses; empty if there is none.
std::vector<char> unused_vertices(MeshView mesh);
/// The box around all vertices that are used.
Box bounds_of_used(MeshView mesh, const std::vector<char>& unused);

/// A valid mesh in the unit space, without normals. `layer` must outlive the part, unless it is cut.
DrawnPart part_of(const MeshLayer& layer, const UnitSpace& space, std::vector<char> unused);
/// Gives each vertex the mean of its triangles' normals, weighted by area: the same bits for any number of threads.
void smooth(DrawnPart& part);

/// The half space of points with along(point) <= most.
struct HalfSpace {
  Axis axis = Axis::z;
  float most = 0;
  bool reversed = false;  ///< all signs are

  float beyond(Float3 p) const {
    const float at = axis == Axis::x ? p.x : axis == Axis::y ? p.y : p.z;
    return reversed ? most - at : at - most;
  }
};
/// Leaves out what lies beyond a half space; triangles that cross its plane are cut there.
void cut(DrawnPart& part, const HalfSpace& kept);

/// The edges of a part's triangles where the surface ends, more than two triangles meet, or two at more than 30
/// degrees; as pairs of vertices.
std::vector<std::array<std::uint32_t, 2>> feature_edges(const DrawnPart& part);

}  // namespace standoff
