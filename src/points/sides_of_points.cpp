// SPDX-License-Identifier: Apache-2.0
#include "points/sides_of_points.h"

#include "points/known_windings.h"
#include "points/open_sides.h"
#include "points/ray_winding.h"
#include "sign/normal/pseudonormals.h"
#include "sign/rows/row_crossings.h"
#include "standoff/error.h"

namespace standoff {
namespace {

// The winding number of a closed mesh does not change where no triangle is. So points whose empty balls overlap have
// the same number. Of the other points, most have a ball of a point before on one of their rows: a segment up to there
// says by how much their numbers differ. Only the rest sends a ray.
class ClosedSides final : public SidesOfPoints {
 public:
  /// `all_near`: free radii are those of all triangles. Where hidden ones do not count, sides are the same within a
  /// ball, but numbers may differ.
  ClosedSides(const OrientedMesh& mesh, const TriangleIndex& index, WindingRule rule, bool all_near)
      : rays_(mesh, index), rule_(rule), all_near_(all_near) {}

  void decide(std::span<const PointToSide> points, const cpu::PointKernels& kernels, WorkCheck& check,
              std::span<bool> inside) const override {
    constexpr std::int64_t kRay = 32;  // about that much work, or far more
    KnownWindings known(rays_, kernels);
    const auto by_ray = [&](const Vec3& at) {
      check.add(kRay);
      return rays_.at(at, kernels);
    };
    for (std::size_t n = 0; n < points.size(); ++n)
      inside[n] =
          is_inside(known.in_ball(points[n].at, points[n].free_radius,
                                  [&](const Vec3& at) { return all_near_ ? known.on_row(at, by_ray) : by_ray(at); }),
                    rule_);
  }
  double winding_number(Vec3 point, const cpu::PointKernels& kernels, WorkCheck&) const override {
    return rays_.at(point, kernels);
  }

 private:
  RayWinding rays_;
  WindingRule rule_;
  bool all_near_;
};

class NormalSidesOfPoints final : public SidesOfPoints {
 public:
  explicit NormalSidesOfPoints(const OrientedMesh& mesh)
      : normals_(mesh), bytes_(static_cast<std::int64_t>(150 * mesh.mesh.triangles.size())) {}

  void decide(std::span<const PointToSide> points, const cpu::PointKernels&, WorkCheck&,
              std::span<bool> inside) const override {
    for (std::size_t n = 0; n < points.size(); ++n)
      inside[n] = normals_.place_of(points[n].at, points[n].triangle) == Pseudonormals::Place::back;
  }
  std::int64_t memory_bytes() const override { return bytes_; }

 private:
  Pseudonormals normals_;
  std::int64_t bytes_;
};

}  // namespace

double SidesOfPoints::winding_number(Vec3, const cpu::PointKernels&, WorkCheck&) const {
  throw Error(ErrorCode::usage, "points: only a query whose sign method is winding knows winding numbers");
}

std::unique_ptr<SidesOfPoints> make_sides_of_points(const OrientedMesh& mesh, const TriangleIndex& index,
                                                    const SignPlan& plan, WindingRule rule, int threads, Simd simd) {
  switch (plan.report.method) {
    case SignMethod::winding:
      if (plan.boundary.edges.empty()) return std::make_unique<ClosedSides>(mesh, index, rule, plan.exposed.empty());
      return std::make_unique<OpenSides>(mesh, index, plan.boundary, rule, threads, simd);
    case SignMethod::parity:
      return std::make_unique<ClosedSides>(mesh, index, WindingRule::odd, plan.exposed.empty());
    case SignMethod::normal:
      return std::make_unique<NormalSidesOfPoints>(mesh);
    default:
      return nullptr;
  }
}

}  // namespace standoff
