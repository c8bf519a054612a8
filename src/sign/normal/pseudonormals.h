// SPDX-License-Identifier: Apache-2.0
// On which side of an oriented mesh a point is, by the normal of the closest face, edge or vertex.
//
// The normal of an edge is the sum of the unit normals of its triangles; that of a vertex is the sum weighted with the
// triangles' angles there. For closed meshes that do not intersect themselves, the sign of the product with the
// direction from the closest point is the side, exactly (Baerentzen and Aanaes 2005); no other simple average has that
// property.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sign/diagnosis/mesh_edges.h"
#include "sign/oriented_mesh.h"

namespace standoff {

class Pseudonormals {
 public:
  /// Requires a valid mesh. Vertices count by position. Triangles without area have no normal. Takes 150 bytes for each
  /// triangle. Runs on the threads of the calling TBB arena.
  explicit Pseudonormals(const OrientedMesh& mesh);

  /// Where p is: normals point to the front. Requires the index of a triangle that is nearest to p, about; which of
  /// several does not matter if they share the closest feature. Front where the normals cancel, or there are none.
  enum class Place { front, back, on_surface };
  Place place_of(const Vec3& p, std::uint32_t triangle) const;

 private:
  void set_normals_of_sides(const std::vector<Vec3>& units);

  OrientedMesh mesh_;
  MeshEdges edges_;
  std::vector<std::int8_t>
      facing_;                     // of each triangle, and all at the same corners: 1 as it is, -1 reversed, 0 neither
  std::vector<Vec3> of_sides_;     // three of each triangle
  std::vector<Vec3> of_vertices_;  // by position
};

}  // namespace standoff
