// SPDX-License-Identifier: Apache-2.0
#include "points/sides_of_points.h"

#include <array>

#include "points/open_point_winding.h"
#include "points/ray_winding.h"
#include "sign/normal/pseudonormals.h"
#include "sign/rows/integer_winding.h"
#include "standoff/error.h"

namespace standoff {
namespace {

// The winding number of a closed mesh does not change where no triangle is. So points whose empty balls overlap have the
// same number, and only one of them sends a ray.
class ClosedSides final : public SidesOfPoints {
 public:
  ClosedSides(const OrientedMesh& mesh, const TriangleIndex& index, WindingRule rule)
      : rays_(mesh, index), rule_(rule) {}

  void decide(std::span<const PointToSide> points, const cpu::PointKernels& kernels,
              std::span<bool> inside) const override {
    std::array<Known, kMostKnown> known;
    std::size_t count = 0, next = 0;
    for (std::size_t n = 0; n < points.size(); ++n) {
      const PointToSide& p = points[n];
      const Known* same = nullptr;
      for (std::size_t k = 0; k < count && !same; ++k)
        if (no_triangle_between(p, *known[k].point)) same = &known[k];
      if (same) {
        inside[n] = same->inside;
        if (p.free_radius <= same->point->free_radius) continue;  // the other one says more about others
      } else {
        inside[n] = is_inside(rays_.at(p.at, kernels), rule_);
      }
      known[next] = {&p, inside[n]};
      next = (next + 1) % kMostKnown;
      count = std::max(count, next == 0 ? kMostKnown : next);
    }
  }
  double winding_number(Vec3 point, const cpu::PointKernels& kernels) const override {
    return rays_.at(point, kernels);
  }

 private:
  struct Known {
    const PointToSide* point;
    bool inside;
  };
  static constexpr std::size_t kMostKnown = 8;

  // Whether the empty balls around two points overlap. A free radius is off by some 1e-16 of the coordinates; the margin
  // is far above that.
  static bool no_triangle_between(const PointToSide& a, const PointToSide& b) {
    const double most = a.free_radius + b.free_radius - 1e-12 * (max_norm(a.at) + max_norm(b.at));
    const Vec3 between = a.at - b.at;
    return most > 0 && dot(between, between) < most * most * (1 - 1e-12);
  }

  RayWinding rays_;
  WindingRule rule_;
};

class OpenSides final : public SidesOfPoints {
 public:
  OpenSides(const OrientedMesh& mesh, const TriangleIndex& index, const Boundary& boundary, WindingRule rule,
            int threads, Simd simd)
      : winding_(mesh, index, boundary, threads, simd), rule_(rule) {}

  void decide(std::span<const PointToSide> points, const cpu::PointKernels& kernels,
              std::span<bool> inside) const override {
    for (std::size_t n = 0; n < points.size(); ++n) inside[n] = winding_.is_inside(points[n].at, rule_, kernels);
  }
  double winding_number(Vec3 point, const cpu::PointKernels& kernels) const override {
    return winding_.at(point, kernels);
  }
  std::int64_t memory_bytes() const override { return winding_.memory_bytes(); }

 private:
  OpenPointWinding winding_;
  WindingRule rule_;
};

class NormalSidesOfPoints final : public SidesOfPoints {
 public:
  explicit NormalSidesOfPoints(const OrientedMesh& mesh)
      : normals_(mesh), bytes_(static_cast<std::int64_t>(150 * mesh.mesh.triangles.size())) {}

  void decide(std::span<const PointToSide> points, const cpu::PointKernels&, std::span<bool> inside) const override {
    for (std::size_t n = 0; n < points.size(); ++n)
      inside[n] = normals_.place_of(points[n].at, points[n].triangle) == Pseudonormals::Place::back;
  }
  std::int64_t memory_bytes() const override { return bytes_; }

 private:
  Pseudonormals normals_;
  std::int64_t bytes_;
};

}  // namespace

double SidesOfPoints::winding_number(Vec3, const cpu::PointKernels&) const {
  throw Error(ErrorCode::usage, "points: only a query whose sign method is winding knows winding numbers");
}

std::unique_ptr<SidesOfPoints> make_sides_of_points(const OrientedMesh& mesh, const TriangleIndex& index,
                                                    const SignPlan& plan, WindingRule rule, int threads, Simd simd) {
  switch (plan.report.method) {
    case SignMethod::winding:
      if (plan.boundary.edges.empty()) return std::make_unique<ClosedSides>(mesh, index, rule);
      return std::make_unique<OpenSides>(mesh, index, plan.boundary, rule, threads, simd);
    case SignMethod::parity:
      return std::make_unique<ClosedSides>(mesh, index, WindingRule::odd);
    case SignMethod::normal:
      return std::make_unique<NormalSidesOfPoints>(mesh);
    default:
      return nullptr;
  }
}

}  // namespace standoff
