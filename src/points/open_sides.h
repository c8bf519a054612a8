// SPDX-License-Identifier: Apache-2.0
// The sides of points beside an open mesh.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "points/open_point_winding.h"
#include "points/sides_of_points.h"
#include "standoff/sign.h"

namespace standoff {

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
