// SPDX-License-Identifier: Apache-2.0
#include "sign/normal/closest_triangle.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>
#include <span>
#include <vector>

#include "geometry/triangle_box.h"
#include "geometry/triangle_distance.h"
#include "sign/diagnosis/along_curve.h"

namespace standoff {
namespace {

std::vector<Box> boxes_of_runs(MeshView mesh, std::span<const std::uint32_t> order, std::size_t run) {
  std::vector<Box> boxes((order.size() + run - 1) / run);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, boxes.size(), 256), [&](const auto& range) {
    for (std::size_t n = range.begin(); n != range.end(); ++n)
      for (std::size_t t = run * n; t < std::min(run * (n + 1), order.size()); ++t)
        for (const Vec3& corner : mesh.corners(order[t])) boxes[n].include(corner);
  });
  return boxes;
}

// All copies of a triangle are equally near; along the curve most of them come one after the other.
std::vector<std::uint32_t> without_neighbouring_copies(MeshView mesh, std::vector<std::uint32_t> order) {
  const auto is_copy = [&](std::uint32_t a, std::uint32_t b) { return mesh.corners(a) == mesh.corners(b); };
  order.erase(std::unique(order.begin(), order.end(), is_copy), order.end());
  return order;
}

// Relative to the point, so that a place far from the origin loses nothing.
double distance_sq_of(const std::array<Vec3, 3>& t, const Vec3& p) {
  return origin_distance_sq(triple_of(t[0] - p), triple_of(t[1] - p), triple_of(t[2] - p));
}

}  // namespace

ClosestTriangle::ClosestTriangle(MeshView mesh)
    : mesh_(mesh),
      order_(without_neighbouring_copies(mesh, along_curve(mesh))),
      runs_(boxes_of_runs(mesh, order_, kRun)) {}

std::uint32_t ClosestTriangle::to(const Vec3& p) const {
  std::uint32_t closest = order_.empty() ? kNoTriangle : order_.front();
  double least_sq = std::numeric_limits<double>::infinity();
  runs_.for_each_within(p, least_sq, [&](std::size_t run) {
    const std::size_t first = kRun * run;
    for (const std::uint32_t t : std::span(order_).subspan(first, std::min(kRun, order_.size() - first))) {
      const double sq = distance_sq_of(mesh_.corners(t), p);
      if (!(sq < least_sq)) continue;
      least_sq = sq;
      closest = t;
    }
  });
  return closest;
}

}  // namespace standoff
