// SPDX-License-Identifier: Apache-2.0
#include "fly/crossing_check.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace standoff::fly {
namespace {

constexpr int kRayDirections = 32;
constexpr double kMostCells = 4e6;

bool overlap(const Box& a, const Box& b) {
  return a.min.x <= b.max.x && b.min.x <= a.max.x && a.min.y <= b.max.y && b.min.y <= a.max.y && a.min.z <= b.max.z &&
         b.min.z <= a.max.z;
}

double component(Vec3 v, int axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

}  // namespace

CrossingCheck::CrossingCheck(MeshView mesh, const Pose& pose) {
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Corners c{apply(pose, mesh.corner(t, 0)), apply(pose, mesh.corner(t, 1)), apply(pose, mesh.corner(t, 2))};
    Box box;
    for (const Vec3& corner : c) box.include(corner);
    box_.include(box.min);
    box_.include(box.max);
    triangles_.push_back(c);
    boxes_.push_back(box);
  }
  const Vec3 e = box_.extent();
  const double longest = std::max(box_.longest_side(), 1e-300);
  // About one cell for each triangle, were they spread over the box; a flat box counts as a hundredth high.
  const double volume = std::max(e.x, longest / 100) * std::max(e.y, longest / 100) * std::max(e.z, longest / 100);
  cell_ = std::max(std::cbrt(volume / std::min(static_cast<double>(triangles_.size()), kMostCells)), longest / 1000);
  for (int axis = 0; axis < 3; ++axis) size_[axis] = static_cast<std::int64_t>(component(e, axis) / cell_) + 1;
  first_.assign(static_cast<std::size_t>(size_[0] * size_[1] * size_[2]) + 1, 0);
  const auto each = [&](auto use) {
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) {
      const Range r = cells(boxes_[t]);
      for (auto z = r.begin[2]; z < r.end[2]; ++z)
        for (auto y = r.begin[1]; y < r.end[1]; ++y)
          for (auto x = r.begin[0]; x < r.end[0]; ++x)
            use(t, static_cast<std::size_t>((z * size_[1] + y) * size_[0] + x));
    }
  };
  each([&](std::uint32_t, std::size_t cell) { ++first_[cell + 1]; });
  for (std::size_t n = 1; n < first_.size(); ++n) first_[n] += first_[n - 1];
  members_.resize(first_.back());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  each([&](std::uint32_t t, std::size_t cell) { members_[next[cell]++] = t; });
}

CrossingCheck::Range CrossingCheck::cells(const Box& box) const {
  Range range{};
  for (int axis = 0; axis < 3; ++axis) {
    // A margin of a millionth of a cell covers the rounding.
    const double low = std::floor((component(box.min, axis) - component(box_.min, axis)) / cell_ - 1e-6);
    const double high = std::floor((component(box.max, axis) - component(box_.min, axis)) / cell_ + 1e-6) + 1;
    range.begin[axis] = static_cast<std::int64_t>(std::clamp(low, 0.0, static_cast<double>(size_[axis])));
    range.end[axis] = static_cast<std::int64_t>(std::clamp(high, 0.0, static_cast<double>(size_[axis])));
  }
  return range;
}

bool CrossingCheck::crosses(Vec3 from, Vec3 to) const {
  Box box;
  box.include(from);
  box.include(to);
  if (!overlap(box, box_)) return false;
  const Corners segment{from, to, to};
  const Range r = cells(box);
  for (auto z = r.begin[2]; z < r.end[2]; ++z)
    for (auto y = r.begin[1]; y < r.end[1]; ++y)
      for (auto x = r.begin[0]; x < r.end[0]; ++x) {
        const auto cell = static_cast<std::size_t>((z * size_[1] + y) * size_[0] + x);
        for (auto n = first_[cell]; n < first_[cell + 1]; ++n)
          if (overlap(box, boxes_[members_[n]]) && triangles_intersect(segment, triangles_[members_[n]])) return true;
      }
  return false;
}

std::vector<Vec3> outermost_points(MeshView mesh) {
  std::vector<Vec3> points{bounds(mesh).center()};
  for (int n = 0; n < kRayDirections; ++n) {
    // Directions spread evenly over the sphere, on a spiral of the golden angle.
    const double z = 1 - (2 * n + 1.0) / kRayDirections, r = std::sqrt(1 - z * z);
    const double angle = n * std::numbers::pi * (3 - std::sqrt(5.0));
    const Vec3 direction{r * std::cos(angle), r * std::sin(angle), z};
    Vec3 farthest = mesh.corner(0, 0);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      for (int k = 0; k < 3; ++k)
        if (dot(direction, mesh.corner(t, k)) > dot(direction, farthest)) farthest = mesh.corner(t, k);
    if (std::find(points.begin(), points.end(), farthest) == points.end()) points.push_back(farthest);
  }
  return points;
}

}  // namespace standoff::fly
