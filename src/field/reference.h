// SPDX-License-Identifier: Apache-2.0
// The reference that verify compares fields with: distances to all triangles of a mesh in double precision, and winding
// numbers.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sign/oriented_mesh.h"
#include "standoff/mesh.h"

namespace standoff {

/// Distances to triangles, which lie in small groups of neighbours. A triangle or group is skipped only if its box is
/// no nearer than a distance already found; both are computed in double, so the error is at most their rounding (a few
/// 1e-16 of the distance). Takes 40 bytes per triangle while it is made and about 6 afterwards. The mesh must be valid
/// and outlive this.
class TriangleGroups {
 public:
  /// Holds the triangles in `among`, which ascend; all triangles if it is empty.
  explicit TriangleGroups(MeshView mesh, std::span<const std::uint32_t> among = {});

  /// The number of triangles of the mesh.
  std::size_t triangle_count() const { return mesh_.triangles.size(); }
  /// The distance from p to these triangles.
  double distance(Vec3 p) const;
  /// The distance from p to one triangle.
  double distance(Vec3 p, std::uint32_t triangle) const;
  /// Calls use(triangle) for each triangle that is no farther from p than `most`.
  template <class Use>
  void for_each_within(Vec3 p, double most, const Use& use) const {
    for (std::size_t g = 0; g < boxes_.size(); ++g) {
      const Vec3 outside = max(max(boxes_[g].min - p, p - boxes_[g].max), Vec3{});
      if (!(length(outside) <= most)) continue;
      for (const std::uint32_t triangle : group(g))
        if (distance(p, triangle) <= most) use(triangle);
    }
  }
  /// Calls use(triangle) for each triangle whose box meets the ray from p along +y, and for the others of its group.
  template <class Use>
  void for_each_above(Vec3 p, const Use& use) const {
    for (std::size_t g = 0; g < boxes_.size(); ++g) {
      const Box& box = boxes_[g];
      if (box.min.x <= p.x && p.x <= box.max.x && box.min.z <= p.z && p.z <= box.max.z && p.y <= box.max.y)
        for (const std::uint32_t triangle : group(g)) use(triangle);
    }
  }

 private:
  static constexpr std::size_t kGroup = 32;

  std::span<const std::uint32_t> group(std::size_t g) const;
  // Lowers `best_sq` to the squared distances from the triangles of a group.
  void look_at(std::size_t g, Vec3 p, double& best_sq) const;
  double triangle_distance_sq(Vec3 p, std::uint32_t triangle) const;

  MeshView mesh_;
  std::vector<std::uint32_t> order_;  // triangles along a space-filling curve
  std::vector<Box> boxes_;            // one per group of kGroup triangles
};

// Winding numbers to check signs with. They are slow and simple, and share nothing with src/sign: other rays, other
// decisions on edges, and no rays at all for open meshes.

struct ReferenceWinding {
  double value = 0;
  double error = 0;         ///< bounds the distance of `value` from the true number
  bool on_surface = false;  ///< the point is exactly on a triangle, and so neither inside nor outside
};

/// The winding number of a closed mesh: the crossings of the ray from p along +y, counted exactly. If the mesh is
/// closed but not oriented, the parity of the number is right. Tests the box of every group of 32 triangles, and the
/// triangles near the ray. Requires the groups of the same mesh, and coordinates that are zero or of magnitude 1e-90 to
/// 1e100.
ReferenceWinding winding_by_crossings(const OrientedMesh& mesh, const TriangleGroups& groups, const Vec3& p);

/// The generalised winding number of any mesh: the sum of all triangles' solid angles over 4 pi (van Oosterom and
/// Strackee 1983). The error is infinite at a corner of a triangle.
ReferenceWinding winding_by_angles(const OrientedMesh& mesh, const Vec3& p);

}  // namespace standoff
