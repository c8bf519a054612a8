// SPDX-License-Identifier: Apache-2.0
// The generalised winding number of an open mesh at a point (docs/open_winding.md): an exact integer, that of the mesh
// with a cap on each hole, and the solid angles of the caps.
#pragma once

#include <memory>

#include "points/ray_winding.h"
#include "sign/diagnosis/boundary.h"
#include "sign/open_winding/rim_tree.h"
#include "sign/open_winding/rims.h"
#include "standoff/sign.h"

namespace standoff {

class OpenPointWinding {
 public:
  /// `boundary` is that of the mesh and not empty. Runs on the threads of the calling TBB arena.
  OpenPointWinding(const OrientedMesh& mesh, const TriangleIndex& index, const Boundary& boundary, int threads,
                   Simd simd);

  /// Within 1e-9, unless the point is on the boundary within rounding. Linear in the size of the boundary.
  double at(Vec3 point, const cpu::PointKernels& kernels) const;
  /// On which side of the rule's thresholds it is: decided by an interval that it is certain to be in. Where rounding
  /// hides the side, by the rounded number.
  struct Side {
    bool inside;
    double margin;  ///< at least so far from a threshold; 0 if rounding hides it
  };
  Side side(Vec3 point, WindingRule rule, const cpu::PointKernels& kernels) const;
  std::int64_t memory_bytes() const;

 private:
  std::int32_t closed_winding(Vec3 point, const cpu::PointKernels& kernels) const;

  RayWinding mesh_;
  Rims rims_;
  RimTree tree_;
  Mesh caps_;
  std::unique_ptr<TriangleIndex> cap_index_;
};

}  // namespace standoff
