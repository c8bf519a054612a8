// SPDX-License-Identifier: Apache-2.0
// Points sorted into a square grid over y and z: which of them a box along x may hold is found without looking at all.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "standoff/vec.h"

namespace standoff {

/// A point of a part of a mesh.
struct PartPoint {
  Vec3 at;
  std::uint32_t part;
};

class PointCells {
 public:
  explicit PointCells(std::span<const PartPoint> points) {
    for (const PartPoint& point : points) box_.include(point.at);
    side_ = std::clamp<std::int64_t>(std::llround(std::sqrt(double(points.size()))), 1, 1024);
    begin_.resize(static_cast<std::size_t>(side_ * side_) + 1);
    for (const PartPoint& point : points) ++begin_[cell_of(point) + 1];
    for (std::size_t n = 1; n < begin_.size(); ++n) begin_[n] += begin_[n - 1];
    sorted_.resize(points.size());
    std::vector<std::uint32_t> next(begin_.begin(), begin_.end() - 1);
    for (std::uint32_t n = 0; n < points.size(); ++n) sorted_[next[cell_of(points[n])]++] = {points[n], n};
  }

  /// How many points for_each() visits.
  std::int64_t count(const Box& box) const {
    std::int64_t sum = 0;
    for_each_run(box, [&](std::uint32_t first, std::uint32_t past) { sum += past - first; });
    return sum;
  }
  /// Calls visit(point, number) for all points whose y and z are in the box, and for some others.
  template <class Visit>
  void for_each(const Box& box, const Visit& visit) const {
    for_each_run(box, [&](std::uint32_t first, std::uint32_t past) {
      for (std::uint32_t n = first; n < past; ++n) visit(sorted_[n].point, sorted_[n].number);
    });
  }

 private:
  struct Numbered {
    PartPoint point;
    std::uint32_t number;
  };

  // Monotone, so that a point between two others is in a cell between theirs.
  std::int64_t along(double value, double min, double max) const {
    const double width = max / 2 - min / 2;  // finite whatever the numbers are
    const double share = width > 0 ? (value / 2 - min / 2) / width : 0;
    return static_cast<std::int64_t>(std::clamp(share * double(side_), 0.0, double(side_ - 1)));
  }
  std::int64_t y_of(double y) const { return along(y, box_.min.y, box_.max.y); }
  std::int64_t z_of(double z) const { return along(z, box_.min.z, box_.max.z); }
  std::size_t cell_of(const PartPoint& point) const {
    return static_cast<std::size_t>(y_of(point.at.y) + side_ * z_of(point.at.z));
  }
  // A row of cells is one run of points.
  template <class Use>
  void for_each_run(const Box& box, const Use& use) const {
    if (box.max.y < box_.min.y || box.min.y > box_.max.y || box.max.z < box_.min.z || box.min.z > box_.max.z ||
        box.max.x < box_.min.x)
      return;
    const std::int64_t first = y_of(box.min.y), last = y_of(box.max.y);
    for (std::int64_t z = z_of(box.min.z), end = z_of(box.max.z); z <= end; ++z)
      use(begin_[static_cast<std::size_t>(first + side_ * z)], begin_[static_cast<std::size_t>(last + side_ * z) + 1]);
  }

  Box box_;
  std::int64_t side_ = 1;
  std::vector<std::uint32_t> begin_;
  std::vector<Numbered> sorted_;
};

}  // namespace standoff
