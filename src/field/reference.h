// SPDX-License-Identifier: Apache-2.0
// What verify compares fields with: exact distances to all triangles of a mesh, in small groups of neighbours, in
// double precision; and winding numbers.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "sign/oriented_mesh.h"
#include "standoff/mesh.h"

namespace standoff {

// Exact distances.

/// A triangle or group is passed over only when its box is no nearer than a distance already found; both are computed
/// in double, so this costs at most their rounding (a few 1e-16 of the distance). Takes 40 bytes per triangle while it
/// is made and about 6 afterwards. The mesh must be valid and outlive this.
class TriangleGroups {
 public:
  /// Of the triangles in `among`, ascending; of all if that is empty.
  explicit TriangleGroups(MeshView mesh, std::span<const std::uint32_t> among = {});

  /// Of the mesh.
  std::size_t triangle_count() const { return mesh_.triangles.size(); }
  /// The distance from p to these triangles.
  double distance(Vec3 p) const;
  /// The triangle nearest to p, of equally near ones that of lowest index.
  std::uint32_t nearest(Vec3 p) const;
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
  /// Calls use(triangle) for triangles in groups of neighbours: for all of a group or for none. Each triangle whose box
  /// meets the ray from p along +y is among them.
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
  struct Found {
    double distance_sq = std::numeric_limits<double>::infinity();
    std::uint32_t triangle = kNoTriangle;
  };

  Found find(Vec3 p) const;
  void look_at(std::size_t g, Vec3 p, Found& best) const;
  double triangle_distance_sq(Vec3 p, std::uint32_t triangle) const;

  MeshView mesh_;
  std::vector<std::uint32_t> order_;  // triangles along a space-filling curve
  std::vector<Box> boxes_;            // of kGroup triangles each
};

// Winding numbers to check signs with. Slow and simple, and nothing of it comes from src/sign: other rays, other
// decisions on edges, and for open meshes no rays at all.

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
