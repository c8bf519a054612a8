// SPDX-License-Identifier: Apache-2.0
// On which side of an oriented mesh a point is, by the normal of the closest face, edge or vertex.
//
// The normal of an edge is the sum of the unit normals of its triangles; the normal of a vertex is their sum weighted
// with the triangles' angles there. For closed meshes that do not intersect themselves, the sign of its product with
// the direction from the closest point tells the side, exactly (Baerentzen and Aanaes 2005). No other simple average
// has this property.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "sign/diagnosis/mesh_edges.h"
#include "sign/oriented_mesh.h"

namespace standoff {

struct TriangleNormal {
  Vec3 unit;          ///< zero if the triangle has no area
  double length = 0;  ///< twice the area
};

/// The normal of a triangle, within 1e-14 however thin the triangle is, and zero only if it has no area. Requires
/// coordinates that are zero or of magnitude 1e-90 to 1e100.
TriangleNormal exact_normal(const std::array<Vec3, 3>& t);

class Pseudonormals {
 public:
  /// Requires a valid mesh. Vertices count by position. Triangles without area have no normal. Takes 150 bytes for each
  /// triangle. Runs on the threads of the calling TBB arena.
  explicit Pseudonormals(const OrientedMesh& mesh);

  /// The side of p: normals point to the front. Requires a triangle that is nearest to p, within rounding; which of
  /// several does not matter if they share the closest feature. Front where the normals cancel, or there are none.
  enum class Place { front, back, on_surface };
  Place place_of(const Vec3& p, std::uint32_t triangle) const;

 private:
  void set_normals_of_sides(const std::vector<Vec3>& units);

  OrientedMesh mesh_;
  MeshEdges edges_;
  // The net orientation of each triangle together with all at the same corners: 1 as it is, -1 reversed, 0 neither.
  std::vector<std::int8_t> facing_;
  std::vector<Vec3> of_sides_;     // three per triangle
  std::vector<Vec3> of_vertices_;  // by position
};

}  // namespace standoff
