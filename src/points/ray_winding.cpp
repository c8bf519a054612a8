// SPDX-License-Identifier: Apache-2.0
#include "points/ray_winding.h"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>

#include "sign/rows/ray_crossing.h"

namespace standoff {
namespace {

constexpr double kInfinite = std::numeric_limits<double>::infinity();

std::array<double, 3> numbers_of(const Vec3& v) { return {v.x, v.y, v.z}; }

// In turned coordinates. Points are displaced most along y, whatever it is called there.
inline RayTriangle triangle_along(const std::array<Vec3, 3>& t, int axis) {
  return RayTriangle({turned(t[0], axis), turned(t[1], axis), turned(t[2], axis)}, (4 - axis) % 3);
}

}  // namespace

RayWinding::RayWinding(const OrientedMesh& mesh, const TriangleIndex& index) : mesh_(mesh), index_(index) {
  const FloatBox all = index.bvh().box();
  low_ = {all.low[0], all.low[1], all.low[2]};
  high_ = {all.high[0], all.high[1], all.high[2]};
}

// Of the points only what lies in the box around all is looked at: there they are near enough for boxes in float, which
// are grown by what rounding takes.
template <class Use>
void RayWinding::for_each_between(int axis, const Vec3& local, double from, double to, const cpu::PointKernels& kernels,
                                  const Use& use) const {
  const std::array<double, 3> at = numbers_of(local), least = numbers_of(low_), most = numbers_of(high_);
  FloatBox way;
  for (int n = 0; n < 3; ++n) {
    const auto axis_of = static_cast<std::size_t>(n);
    const double first = std::max(n == axis ? from : at[axis_of], least[axis_of]),
                 last = std::min(n == axis ? to : at[axis_of], most[axis_of]);
    if (!(first <= last)) return;
    way.low[n] = static_cast<float>(first);
    way.high[n] = static_cast<float>(last);
  }
  for_each_overlap(index_.bvh(), way, kernels.overlapping, [&](std::uint32_t place) {
    const std::uint32_t triangle = index_.bvh().order()[place];
    if (const int times = mesh_.use_of(triangle)) use(triangle_along(mesh_.mesh.corners(triangle), axis), times);
  });
}

RayWay RayWinding::shortest(Vec3 point) const {
  const Vec3 local = index_.local(point);
  const std::array<double, 3> down = numbers_of(local - low_), up = numbers_of(high_ - local);
  RayWay best{0, false};
  double length = down[0];
  for (int axis = 0; axis < 3; ++axis)
    for (const bool is_up : {false, true}) {
      const double own = (is_up ? up : down)[static_cast<std::size_t>(axis)];
      if (own < length) length = own, best = {axis, is_up};
    }
  return best;
}

std::int32_t RayWinding::at(Vec3 point, RayWay way, const cpu::PointKernels& kernels) const {
  const Vec3 local = index_.local(point), own = turned(point, way.axis);
  const double start = turned(local, way.axis).x;
  std::int32_t winding = 0;
  for_each_between(way.axis, local, way.up ? start : -kInfinite, way.up ? kInfinite : start, kernels,
                   [&](const RayTriangle& triangle, int times) {
                     const int crossing = triangle.crossing(own.y, own.z);
                     if (crossing != 0 && triangle.is_past(own, crossing) != way.up)
                       winding += way.up ? times * crossing : -times * crossing;
                   });
  return winding;
}

std::int32_t RayWinding::beyond(int axis, double other, Vec3 point, const cpu::PointKernels& kernels) const {
  const Vec3 local = index_.local(point), own = turned(point, axis), end{other, own.y, own.z};
  const double own_at = turned(local, axis).x;
  // Back in its own coordinates: turned by the rest of the circle.
  const double end_at = turned(index_.local(turned(end, (3 - axis) % 3)), axis).x;
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

}  // namespace standoff
