// SPDX-License-Identifier: Apache-2.0
// Which points are inside an open mesh.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>

#include "points/point_sign.h"
#include "sign/diagnosis/boundary.h"
#include "sign/open_winding/cap_tree.h"
#include "sign/open_winding/caps.h"
#include "standoff/sign.h"

namespace standoff {

// The generalised winding number of an open mesh at a point (docs/open_winding.md): an exact integer, that of the mesh
// with a cap on each hole, and the solid angles of the caps.

/// `check` counts visits of rims (kLooks), and may stop the work.
class OpenPointWinding {
 public:
  /// `boundary` is that of the mesh and not empty. Runs on the threads of the calling TBB arena.
  OpenPointWinding(const OrientedMesh& mesh, const TriangleIndex& index, const Boundary& boundary, int threads,
                   Simd simd);

  /// Within 1e-9, unless the point is on the boundary within rounding. Linear in the size of the boundary, or in the
  /// number of triangles, where that costs less.
  double at(Vec3 point, const cpu::PointKernels& kernels, WorkCheck& check) const;
  /// On which side of the rule's thresholds it is: decided by an interval that it is certain to be in. Where rounding
  /// hides the side, by the rounded number.
  bool side(Vec3 point, WindingRule rule, const cpu::PointKernels& kernels, WorkCheck& check) const;
  /// The same where the number is known within an error below 1/4.
  bool side(Vec3 point, WindingRule rule, const Interval& about, WorkCheck& check) const;

  /// The whole part: the winding number of mesh and caps.
  std::int32_t closed(Vec3 point, const cpu::PointKernels& kernels) const;
  /// The rest, at the points of a cell, but for a whole number that is the same until the mesh is crossed. Right at
  /// the center, as `closed` is there. Where the error is above `most`, the function says nothing.
  LinearField field(const Cell& cell, double tolerance, double most, WorkCheck& check) const;
  const RayWinding& mesh() const { return mesh_; }
  std::int64_t memory_bytes() const;

 private:
  // closed_of(value of a sum of angles): the whole part, if the sum is known within `most`.
  template <class Closed>
  bool side(Vec3 point, WindingRule rule, double most, const Closed& closed_of, WorkCheck& check) const;

  // What the caps add, as cap_sum_at() says.
  Interval cap_sum(Vec3 point, double tolerance, WorkCheck& check) const;
  // The sum of the solid angles of all triangles; nothing beside an edge of one, where rounding decides.
  std::optional<double> sum_of_triangles(Vec3 point, const cpu::PointKernels& kernels) const;

  OrientedMesh oriented_;
  const TriangleIndex& index_;
  bool triangles_cost_less_;
  RayWinding mesh_;
  Rims rims_;
  RimTree tree_;
  Mesh caps_;
  std::unique_ptr<TriangleIndex> cap_index_;
};

// The sides of points beside an open mesh.

/// Between its boundary's edges, the winding number of an open mesh is a smooth function, and a whole number that
/// changes at triangles alone. Where the boundary is far, the function is nearly linear: it is found once for many
/// points, and with it an error that it is certain to be within. The whole numbers are those of a closed mesh.
class OpenSides final : public SidesOfPoints {
 public:
  OpenSides(const OrientedMesh& mesh, const TriangleIndex& index, const Boundary& boundary, WindingRule rule,
            int threads, Simd simd)
      : winding_(mesh, index, boundary, threads, simd), rule_(rule) {}

  void decide(std::span<const PointToSide> points, const cpu::PointKernels& kernels, WorkCheck& check,
              std::span<bool> inside) const override;
  double winding_number(Vec3 point, const cpu::PointKernels& kernels, WorkCheck& check) const override {
    return winding_.at(point, kernels, check);
  }
  bool is_slow() const override { return true; }
  std::int64_t memory_bytes() const override { return winding_.memory_bytes(); }

 private:
  class Points;

  OpenPointWinding winding_;
  WindingRule rule_;
};

}  // namespace standoff
