// SPDX-License-Identifier: Apache-2.0
// The winding number of a closed mesh at a point: the crossings of the ray from the point towards -x, counted exactly.
#pragma once

#include <cstdint>

#include "points/cpu/kernels.h"
#include "points/triangle_index.h"
#include "sign/oriented_mesh.h"

namespace standoff {

class RayWinding {
 public:
  /// Requires the index of all triangles of mesh.mesh; both outlive this.
  RayWinding(const OrientedMesh& mesh, const TriangleIndex& index) : mesh_(mesh), index_(index) {}

  /// The same numbers, with the same symbolic perturbation, as rows of samples have (sign/rows/ray_crossing.h). Of a
  /// mesh that is closed but for its orientation, the parity is right.
  std::int32_t at(Vec3 point, const cpu::PointKernels& kernels) const;
  /// That number less the one at (x, point.y, point.z): the crossings of the segment between the two.
  std::int32_t beyond(double x, Vec3 point, const cpu::PointKernels& kernels) const;
  /// Whether beyond() may be asked about a point.
  bool is_near(Vec3 point) const { return index_.is_near(index_.local(point)); }

 private:
  // Calls use(triangle, how often it counts) for the triangles whose boxes a row meets between two points.
  template <class Use>
  void for_each_between(const float (&to)[3], float from, const cpu::PointKernels& kernels, const Use& use) const;

  const OrientedMesh mesh_;
  const TriangleIndex& index_;
};

}  // namespace standoff
