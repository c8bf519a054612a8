// SPDX-License-Identifier: Apache-2.0
// The winding number of a closed mesh at a point: the crossings of a ray from the point, counted exactly.
#pragma once

#include <cstdint>

#include "points/cpu/kernels.h"
#include "points/triangle_index.h"
#include "sign/oriented_mesh.h"

namespace standoff {

/// The direction of a ray: along an axis, 0 to 2, towards larger or smaller coordinates.
struct RayWay {
  int axis;
  bool up;
};

/// The vector in coordinates whose first axis is `axis`; the other two follow in a circle.
inline Vec3 turned(const Vec3& v, int axis) {
  return axis == 0 ? v : axis == 1 ? Vec3{v.y, v.z, v.x} : Vec3{v.z, v.x, v.y};
}

class RayWinding {
 public:
  /// Requires the index of all triangles of mesh.mesh; both outlive this.
  RayWinding(const OrientedMesh& mesh, const TriangleIndex& index);

  /// The same numbers, with the same symbolic perturbation, as rows of samples have (sign/rows/ray_crossing.h). Of a
  /// mesh that is closed but for its orientation, the parity is right.
  std::int32_t at(Vec3 point, const cpu::PointKernels& kernels) const { return at(point, shortest(point), kernels); }
  /// What the ray that way says: for meshes that are closed only together, which must be asked the same way.
  std::int32_t at(Vec3 point, RayWay way, const cpu::PointKernels& kernels) const;
  /// The way on which a ray leaves the mesh's box soonest.
  RayWay shortest(Vec3 point) const;
  /// The number at the point less the one where its coordinate `axis` is `other`: the crossings between the two.
  std::int32_t beyond(int axis, double other, Vec3 point, const cpu::PointKernels& kernels) const;

 private:
  // Calls use(triangle, how often it counts) for the triangles whose boxes a row meets between two local points, along
  // an axis. The points may be anywhere.
  template <class Use>
  void for_each_between(int axis, const Vec3& local, double from, double to, const cpu::PointKernels& kernels,
                        const Use& use) const;

  const OrientedMesh mesh_;
  const TriangleIndex& index_;
  Vec3 low_, high_;  // of the box around all, local
};

}  // namespace standoff
