// SPDX-License-Identifier: Apache-2.0
// Meshes as pages hold them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "standoff/page.h"

namespace standoff::page {

/// A mesh whose corners lie on a cubic lattice. Vertices are in the order in which triangles name them first; those
/// that no triangle names are left out. Triangles are in the mesh's order, so that a field's nearest triangles are
/// theirs, unless there were too many.
struct LatticeMesh {
  Vec3 origin;      ///< world units, the box's least corner
  double step = 1;  ///< world units
  int bits = 16;    ///< of a coordinate: 16, or 24 where the mesh's triangles are small
  std::vector<std::array<std::uint32_t, 3>> vertices;  ///< in steps from the origin
  std::vector<Triangle> triangles;
  std::vector<Triangle> proxy;  ///< fewer triangles over the same vertices, or none
  bool simplified = false;      ///< there were more than options.most_triangles
};

LatticeMesh lattice_mesh(MeshView mesh, const PageOptions& options);
/// Fills `held`, unless null.
std::string mesh_blob(const PageMesh& mesh, const PageOptions& options, PageItem* held);

}  // namespace standoff::page
