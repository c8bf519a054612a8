// SPDX-License-Identifier: Apache-2.0
// The signs of points beside an open mesh (docs/open_winding.md).
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

/// The generalised winding number of an open mesh at a point. It is the sum of two parts: the whole number of the mesh
/// with a cap on each hole, which is exact, and the solid angles of the caps. `check` counts visits of rims (kLooks),
/// and may stop the work.
class OpenPointWinding {
 public:
  /// Requires that `boundary` is the boundary of the mesh, and not empty. Runs on the threads of the calling TBB arena.
  OpenPointWinding(const OrientedMesh& mesh, const TriangleIndex& index, const Boundary& boundary, int threads,
                   Simd simd);

  /// The number within 1e-9, unless the point is on the boundary within rounding. Takes time linear in the size of the
  /// boundary, or in the number of triangles if that is cheaper.
  double at(Vec3 point, const cpu::PointKernels& kernels, WorkCheck& check) const;
  /// Whether the rule says that the number is inside: decided by an interval that is certain to contain the number, or
  /// by the rounded number where no interval can decide.
  bool is_inside(Vec3 point, WindingRule rule, const cpu::PointKernels& kernels, WorkCheck& check) const;
  /// The same if the number is known within an error below 1/4.
  bool is_inside(Vec3 point, WindingRule rule, const Interval& about, WorkCheck& check) const;

  /// The whole part: the winding number of mesh and caps together.
  std::int32_t closed(Vec3 point, const cpu::PointKernels& kernels) const;
  /// The solid angles of the caps in a cell, continued across the caps: so its sum with `closed` at the center is the
  /// winding number of every point that a path in the cell reaches without crossing the mesh. If the error is above
  /// `most`, the function is of no use.
  LinearField field(const Cell& cell, double tolerance, double most, WorkCheck& check) const;
  const RayWinding& mesh() const { return mesh_; }
  std::int64_t memory_bytes() const;

 private:
  // `closed_of` returns the whole part for a sum of angles, if the sum's error is below `most`.
  template <class Closed>
  bool is_inside(Vec3 point, WindingRule rule, double most, const Closed& closed_of, WorkCheck& check) const;

  Interval cap_sum(Vec3 point, double tolerance, WorkCheck& check) const;
  // The sum of the solid angles of all triangles; nothing if the point is so near an edge that rounding decides.
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

/// The winding number of an open mesh is a smooth function of the point, away from the boundary's edges, plus a whole
/// number that changes at triangles only. Far from the boundary the function is nearly linear: it is found once for
/// many points, with a bound of its error. The whole numbers are found like the winding numbers of a closed mesh.
class OpenPointSigns final : public PointSigns {
 public:
  OpenPointSigns(const OrientedMesh& mesh, const TriangleIndex& index, const Boundary& boundary, WindingRule rule,
                 int threads, Simd simd)
      : winding_(mesh, index, boundary, threads, simd), rule_(rule) {}

  void decide(std::span<const PointToSign> points, const cpu::PointKernels& kernels, WorkCheck& check,
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
