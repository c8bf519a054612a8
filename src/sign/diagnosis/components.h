// SPDX-License-Identifier: Apache-2.0
// The components of an oriented mesh, with their volumes and moments.
#pragma once

#include <cstdint>
#include <vector>

#include "sign/diagnosis/mesh_edges.h"
#include "sign/oriented_mesh.h"
#include "standoff/mesh_report.h"

namespace standoff {

struct Components {
  std::vector<std::uint32_t> of;   ///< for each triangle its component
  std::vector<MeshComponent> all;  ///< in the order of their first triangles; depths are 0
};

/// Requires a mesh oriented by orient(): edges that are inconsistent after that make a component no solid. Triangles
/// that are left out belong to components, but add nothing to them but their bounds. Sums are relative to the
/// centre of each component's bounds, and rounded like sums of as many numbers. Linear.
Components find_components(const OrientedMesh& mesh, const MeshEdges& edges);

}  // namespace standoff
