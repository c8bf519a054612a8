// SPDX-License-Identifier: Apache-2.0
#include "points/point_sign.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "points/open_point_sign.h"
#include "sign/normal/pseudonormals.h"
#include "sign/rows/ray_crossing.h"
#include "sign/rows/row_crossings.h"
#include "standoff/error.h"

namespace standoff {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

std::array<double, 3> numbers_of(const Vec3& v) { return {v.x, v.y, v.z}; }

// A triangle in cycled coordinates. The perturbation displaces points most along the true y, wherever cycling put it.
inline RayTriangle triangle_along(const std::array<Vec3, 3>& t, int axis) {
  return RayTriangle({cycled(t[0], axis), cycled(t[1], axis), cycled(t[2], axis)}, (4 - axis) % 3);
}

}  // namespace

RayWinding::RayWinding(const OrientedMesh& mesh, const TriangleIndex& index) : mesh_(mesh), index_(index) {
  const FloatBox all = index.bvh().box();
  low_ = {all.low[0], all.low[1], all.low[2]};
  high_ = {all.high[0], all.high[1], all.high[2]};
}

// Clips the segment to the box around all triangles: within it, points are near enough for boxes in float, which are
// grown by the rounding error.
template <class Use>
void RayWinding::for_each_between(int axis, const Vec3& local, double from, double to, const cpu::PointKernels& kernels,
                                  const Use& use) const {
  const std::array<double, 3> at = numbers_of(local), least = numbers_of(low_), most = numbers_of(high_);
  FloatBox segment;
  for (int n = 0; n < 3; ++n) {
    const auto axis_of = static_cast<std::size_t>(n);
    const double first = std::max(n == axis ? from : at[axis_of], least[axis_of]),
                 last = std::min(n == axis ? to : at[axis_of], most[axis_of]);
    if (!(first <= last)) return;
    segment.low[n] = static_cast<float>(first);
    segment.high[n] = static_cast<float>(last);
  }
  for_each_overlap(index_.bvh(), segment, kernels.overlapping, [&](std::uint32_t place) {
    const std::uint32_t triangle = index_.bvh().order()[place];
    if (const int times = mesh_.use_of(triangle)) use(triangle_along(mesh_.mesh.corners(triangle), axis), times);
  });
}

RayDirection RayWinding::shortest(Vec3 point) const {
  const Vec3 local = index_.local(point);
  const std::array<double, 3> down = numbers_of(local - low_), up = numbers_of(high_ - local);
  RayDirection best{0, false, down[0]};
  for (int axis = 0; axis < 3; ++axis)
    for (const bool is_up : {false, true}) {
      const double own = (is_up ? up : down)[static_cast<std::size_t>(axis)];
      if (own < best.length) best = {axis, is_up, own};
    }
  return best;
}

std::int32_t RayWinding::at(Vec3 point, RayDirection direction, const cpu::PointKernels& kernels) const {
  const Vec3 local = index_.local(point), own = cycled(point, direction.axis);
  const double start = cycled(local, direction.axis).x;
  std::int32_t winding = 0;
  for_each_between(direction.axis, local, direction.up ? start : -kInfinite, direction.up ? kInfinite : start, kernels,
                   [&](const RayTriangle& triangle, int times) {
                     const int crossing = triangle.crossing(own.y, own.z);
                     if (crossing != 0 && triangle.is_past(own, crossing) != direction.up)
                       winding += direction.up ? times * crossing : -times * crossing;
                   });
  return winding;
}

std::int32_t RayWinding::beyond(int axis, double other, Vec3 point, const cpu::PointKernels& kernels) const {
  const Vec3 local = index_.local(point), own = cycled(point, axis), end{other, own.y, own.z};
  const double own_at = cycled(local, axis).x;
  // The end back in world coordinates: the rest of the cycle undoes it.
  const double end_at = cycled(index_.local(cycled(end, (3 - axis) % 3)), axis).x;
  std::int32_t winding = 0;
  for_each_between(axis, local, std::min(own_at, end_at), std::max(own_at, end_at), kernels,
                   [&](const RayTriangle& triangle, int times) {
                     const int crossing = triangle.crossing(own.y, own.z);
                     if (crossing == 0) return;
                     winding -= times * crossing *
                                (int{triangle.is_past(own, crossing)} - int{triangle.is_past(end, crossing)});
                   });
  return winding;
}

namespace {

// Whether the root of `sq` is less than `than`.
bool is_less(double sq, double than) { return than > 0 && sq < than * than * (1 - 1e-12); }

}  // namespace

void WindingCache::add(const Ball& one) { balls_[count_++ % balls_.size()] = one; }

const WindingCache::Ball* WindingCache::overlapping(const Ball& own) const {
  for (const Ball& other : all()) {
    const Vec3 between = own.at - other.at;
    if (is_less(dot(between, between), own.radius + other.radius)) return &other;
  }
  return nullptr;
}

WindingCache::OnRow WindingCache::nearest_on_rows(const Vec3& at) const {
  OnRow nearest{};
  double length = std::numeric_limits<double>::infinity();
  for (const Ball& other : all())
    for (int axis = 0; axis < 3; ++axis) {
      const Vec3 off = cycled(other.at - at, axis);
      if (std::abs(off.x) < length && is_less(off.y * off.y + off.z * off.z, other.radius))
        nearest = {&other, axis}, length = std::abs(off.x);
    }
  return nearest;
}

const WindingCache::Ball* WindingCache::nearest_center(const Vec3& at) const {
  if (count_ == 0) return nullptr;
  return &*std::ranges::min_element(all(), {}, [&](const Ball& other) { return max_norm(other.at - at); });
}

std::int32_t WindingCache::by_rows_from(const Ball& known, const Vec3& at) const {
  const Vec3 &there = known.at, along_y{there.x, at.y, at.z}, along_z{there.x, there.y, at.z};
  return known.winding + rays_.beyond(0, there.x, at, kernels_) + rays_.beyond(1, there.y, along_y, kernels_) +
         rays_.beyond(2, there.z, along_z, kernels_);
}

namespace {

// The winding number of a closed mesh changes at triangles only. So points whose empty balls overlap have the same
// number. For most other points, a row meets the ball of an earlier point, and the triangles that the segment between
// them crosses give the difference. The rest need a ray, or, where many surfaces lie between a point and the mesh's
// box, three rows from the nearest of the earlier points.
class ClosedPointSigns final : public PointSigns {
 public:
  /// `all_near`: free radii take all triangles into account. If hidden triangles do not count for distances, the sign
  /// is constant within a ball, but the number may change.
  ClosedPointSigns(const OrientedMesh& mesh, const TriangleIndex& index, WindingRule rule, bool all_near)
      : rays_(mesh, index), rule_(rule), all_near_(all_near) {}

  void decide(std::span<const PointToSign> points, const cpu::PointKernels& kernels, WorkCheck& check,
              std::span<bool> inside) const override {
    constexpr std::int64_t kRay = 32;  // a ray costs about this much work, or far more
    // Three rows of this share of a ray's length each take less than the ray. Of 0.125 to 0.5 it is the best one by a
    // tenth for 25,000 tetrahedra that overlap.
    constexpr double kShareOfRay = 0.125;
    WindingCache cache(rays_, kernels);
    const auto anew = [&](const Vec3& at) {
      check.add(kRay);
      const RayDirection ray = rays_.shortest(at);
      const auto by_ray = [&](const Vec3&) { return rays_.at(at, ray, kernels); };
      return all_near_ ? cache.by_rows(at, kShareOfRay * ray.length, by_ray) : by_ray(at);
    };
    for (std::size_t n = 0; n < points.size(); ++n)
      inside[n] =
          is_inside(cache.in_ball(points[n].at, points[n].free_radius,
                                  [&](const Vec3& at) { return all_near_ ? cache.on_row(at, anew) : anew(at); }),
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

class NormalPointSigns final : public PointSigns {
 public:
  explicit NormalPointSigns(const OrientedMesh& mesh)
      : normals_(mesh), bytes_(static_cast<std::int64_t>(150 * mesh.mesh.triangles.size())) {}

  void decide(std::span<const PointToSign> points, const cpu::PointKernels&, WorkCheck&,
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

double PointSigns::winding_number(Vec3, const cpu::PointKernels&, WorkCheck&) const {
  throw Error(ErrorCode::usage, "points: only a query whose sign method is winding knows winding numbers");
}

std::unique_ptr<PointSigns> make_point_signs(const OrientedMesh& mesh, const TriangleIndex& index, const SignPlan& plan,
                                             WindingRule rule, int threads, Simd simd) {
  switch (plan.report.method) {
    case SignMethod::winding:
      if (plan.boundary.edges.empty())
        return std::make_unique<ClosedPointSigns>(mesh, index, rule, plan.exposed.empty());
      return std::make_unique<OpenPointSigns>(mesh, index, plan.boundary, rule, threads, simd);
    case SignMethod::parity:
      return std::make_unique<ClosedPointSigns>(mesh, index, WindingRule::odd, plan.exposed.empty());
    case SignMethod::normal:
      return std::make_unique<NormalPointSigns>(mesh);
    default:
      return nullptr;
  }
}

}  // namespace standoff
