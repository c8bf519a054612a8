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

 private:
  const OrientedMesh mesh_;
  const TriangleIndex& index_;
};

}  // namespace standoff
