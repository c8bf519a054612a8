// SPDX-License-Identifier: Apache-2.0
// Which side of a mesh a point is on, for verify: by what the field says about its sign, but not by how it was
// computed.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "field/triangle_groups.h"
#include "field/winding_reference.h"
#include "sign/sign_text.h"

namespace standoff {

struct SideJudgement {
  std::optional<bool> inside;     ///< empty: on the surface, too near to it for rounding, or it cannot be known here
  std::optional<double> winding;  ///< the reference's winding number, if the side was decided by it
};

/// Whether the edges of the triangles in use cancel, edge by edge.
bool is_closed_in_use(const OrientedMesh& mesh);

class SignJudge {
 public:
  /// `use` as in OrientedMesh. The mesh and the groups must outlive this. Runs on the threads of the calling TBB arena.
  SignJudge(MeshView mesh, const TriangleGroups& groups, const SignText& sign, std::vector<std::int8_t> use);

  /// Whether a side can be judged at all. Of `flood` it is that of points beyond the mesh's box alone; of `normal` that
  /// of points which are on the same side of all nearest triangles; of `shell`, and of a parity that this mesh does not
  /// have, it is none.
  bool can_judge() const { return way_ != Way::none; }
  /// `allowed` is the error that the point's distance may have: world units.
  SideJudgement judge(const Vec3& p, double allowed) const;

 private:
  enum class Way { none, crossings, angles, box, nearest };

  SideJudgement by_winding(const Vec3& p) const;
  std::optional<bool> behind_nearest(const Vec3& p, double allowed) const;
  bool is_inside(double whole) const;

  OrientedMesh mesh_;
  const TriangleGroups& groups_;
  SignText sign_;
  std::vector<std::int8_t> use_;
  Way way_ = Way::none;
  Box box_;
};

}  // namespace standoff
