// SPDX-License-Identifier: Apache-2.0
#include "points/sorted_points.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>
#include <tbb/task_arena.h>

#include <cmath>

#include "geometry/morton.h"

namespace standoff {

SortedPoints::SortedPoints(const TriangleIndex& index, std::span<const Vec3> points) : local_(points.size()) {
  using Blocked = tbb::blocked_range<std::size_t>;
  const auto add = [&](const Blocked& range, Box box) {
    for (std::size_t n = range.begin(); n < range.end(); ++n) {
      local_[n] = index.local(points[n]);
      if (index.is_near(local_[n])) box.include(local_[n]);
    }
    return box;
  };
  const auto both = [](const Box& a, const Box& b) { return Box{min(a.min, b.min), max(a.max, b.max)}; };
  const Box box = tbb::parallel_reduce(Blocked(0, points.size(), 8192), Box{}, add, both);
  for (std::size_t n = 0; n < points.size(); ++n)
    if (!index.is_near(local_[n])) far_.push_back(static_cast<std::uint32_t>(n));
  if (far_.size() == points.size()) return;

  low_ = box.min;
  const double side = box.longest_side();
  cell_ = side > 0 ? side / kSide : 1;
  const double to_cells = 1 / cell_;
  keyed_.resize(points.size() - far_.size());
  // The places of near points: their number less the far ones before them.
  const auto key = [&](std::size_t n) {
    const Vec3 at = (local_[n] - low_) * to_cells;
    const auto cell = [](double v) { return static_cast<std::uint32_t>(v < kSide - 1 ? v : double{kSide - 1}); };
    return static_cast<std::uint32_t>(morton(cell(at.x), cell(at.y), cell(at.z)));
  };
  if (far_.empty()) {
    tbb::parallel_for(Blocked(0, points.size(), 8192), [&](const Blocked& range) {
      for (std::size_t n = range.begin(); n < range.end(); ++n) keyed_[n] = {key(n), static_cast<std::uint32_t>(n)};
    });
  } else {
    std::size_t place = 0;
    for (std::size_t n = 0; n < points.size(); ++n)
      if (index.is_near(local_[n])) keyed_[place++] = {key(n), static_cast<std::uint32_t>(n)};
  }
  cpu::radix_sort(keyed_, tbb::this_task_arena::max_concurrency());
}

SortedPoints::Range SortedPoints::first_of(Range range, const cpu::Cell& cell) const {
  const std::uint64_t first = morton(static_cast<std::uint64_t>(cell.low[0]), static_cast<std::uint64_t>(cell.low[1]),
                                     static_cast<std::uint64_t>(cell.low[2]));
  const auto side = static_cast<std::uint64_t>(cell.side);
  const std::uint64_t end = first + side * side * side;
  const auto at = std::partition_point(keyed_.begin() + range.begin, keyed_.begin() + range.end,
                                       [&](const cpu::KeyedIndex& keyed) { return keyed.key < end; });
  return {range.begin, at - keyed_.begin()};
}

cpu::CullCell SortedPoints::cull_cell(const cpu::Cell& cell) const {
  const double lows[3] = {low_.x, low_.y, low_.z};
  const double half = static_cast<double>(cell.side) / 2 * cell_;
  cpu::CullCell box;
  box.reach = std::numeric_limits<float>::infinity();
  for (int axis = 0; axis < 3; ++axis) {
    const double center = lows[axis] + static_cast<double>(cell.low[axis]) * cell_ + half;
    box.center[axis] = static_cast<float>(center);
    // A point's cell is rounded, and so is the center: by some millionths of the mesh's size.
    box.half[axis] = static_cast<float>(half + std::abs(center - double{box.center[axis]})) * (1 + 1e-6f) + 1e-4f;
  }
  return box;
}

}  // namespace standoff
