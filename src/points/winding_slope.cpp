// SPDX-License-Identifier: Apache-2.0
#include "points/winding_slope.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "geometry/morton.h"

namespace standoff {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Above all rounding, of centers, radii and sums.
constexpr double kRounded = 1 + 1e-9;
// Above what lengths lose whose squares underflow.
constexpr double kLeastLength = 1e-140;

}  // namespace

struct WindingSlope::Sum {
  Vec3 point;
  double radius;
  double most, value = 0;
};

WindingSlope::WindingSlope(const Boundary& boundary) {
  Box box;
  for (const BoundaryEdge& edge : boundary.edges) box.include(edge.from), box.include(edge.to);
  const double side = box.longest_side(), to_cells = side > 0 ? 1023 / side : 0;
  std::vector<std::pair<std::uint64_t, Part>> sorted;
  sorted.reserve(boundary.edges.size());
  for (const BoundaryEdge& edge : boundary.edges) {
    const Vec3 middle = edge.from + (edge.to - edge.from) * 0.5, at = (middle - box.min) * to_cells;
    const Vec3 along = edge.to - edge.from;
    const double size = std::hypot(along.x, along.y, along.z);
    sorted.push_back(
        {morton(static_cast<std::uint32_t>(at.x), static_cast<std::uint32_t>(at.y), static_cast<std::uint32_t>(at.z)),
         {middle, size / 2, size * edge.weight}});
  }
  std::ranges::stable_sort(sorted, {}, &std::pair<std::uint64_t, Part>::first);
  for (const auto& [key, part] : sorted) parts_.push_back(part);
  begin_ = {0, parts_.size()};
  for (std::size_t first = 0; parts_.size() - first > 1; first = begin_[begin_.size() - 2]) {
    const std::size_t end = parts_.size();
    for (std::size_t n = first; n < end; n += kFanout)
      parts_.push_back(around_all(&parts_[n], std::min(kFanout, end - n)));
    begin_.push_back(parts_.size());
  }
}

WindingSlope::Part WindingSlope::around_all(const Part* parts, std::size_t count) {
  Box box;
  for (std::size_t n = 0; n < count; ++n) box.include(parts[n].center);
  Part all{box.center(), 0, 0};
  for (std::size_t n = 0; n < count; ++n) {
    all.radius = std::max(all.radius, (length(parts[n].center - all.center) + parts[n].radius) * kRounded);
    all.length += parts[n].length;
  }
  return all;
}

void WindingSlope::add(std::size_t level, std::size_t number, Sum& sum) const {
  const Part& part = parts_[begin_[level] + number];
  const double far = length(sum.point - part.center), gap = far - (sum.radius + part.radius) * kRounded;
  if (level == 0 || gap > 2 * part.radius) {
    sum.value = gap > std::max(far * 1e-9, kLeastLength) ? sum.value + part.length / (gap * gap) : kInfinity;
    return;
  }
  const std::size_t first = number * kFanout, end = std::min(first + kFanout, begin_[level] - begin_[level - 1]);
  for (std::size_t n = first; n < end && sum.value <= sum.most; ++n) add(level - 1, n, sum);
}

double WindingSlope::around(const Vec3& point, double radius, double most) const {
  if (parts_.empty()) return 0;
  constexpr double kSphere = 4 * std::numbers::pi;
  Sum sum{point, radius, most * kSphere};
  add(begin_.size() - 2, 0, sum);
  return sum.value <= sum.most ? sum.value / kSphere * kRounded : kInfinity;
}

}  // namespace standoff
