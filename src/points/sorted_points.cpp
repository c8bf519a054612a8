// SPDX-License-Identifier: Apache-2.0
#include "points/sorted_points.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>
#include <tbb/task_arena.h>

#include <cmath>

#include "geometry/triangle_box.h"

namespace standoff {
namespace {

using Blocked = tbb::blocked_range<std::size_t>;

}  // namespace

void SortedPoints::sort(const TriangleIndex& index, std::span<const Vec3> points, HugePageVector<std::uint32_t>& order,
                        HugePageVector<Vec3>& in_order) {
  struct Near {
    Box box;
    std::size_t count = 0;
  };
  const auto add = [&](const Blocked& range, Near near) {
    for (std::size_t n = range.begin(); n < range.end(); ++n) {
      const Vec3 local = index.local(points[n]);
      if (!index.is_near(local)) continue;
      near.box.include(local);
      ++near.count;
    }
    return near;
  };
  const auto both = [](const Near& a, const Near& b) {
    return Near{{min(a.box.min, b.box.min), max(a.box.max, b.box.max)}, a.count + b.count};
  };
  const bool is_alone = points.size() <= kAlone;
  const Blocked all(0, points.size(), 8192);
  const Near near = is_alone ? add(all, {}) : tbb::parallel_reduce(all, Near{}, add, both);
  const auto for_all = [&](const auto& work) { is_alone ? work(all) : tbb::parallel_for(all, work); };
  order.resize(points.size());
  in_order.resize(points.size());

  low_ = near.box.min;
  const double side = near.count > 0 ? near.box.longest_side() : 0;
  cell_ = side > 0 ? side / kSide : 1;
  const double to_cells = 1 / cell_;
  keyed_.resize(near.count);
  const auto key = [&](std::size_t n) {
    const Vec3 at = (index.local(points[n]) - low_) * to_cells;
    const auto cell = [](double v) { return static_cast<std::uint32_t>(v < kSide - 1 ? v : double{kSide - 1}); };
    return static_cast<std::uint32_t>(morton(cell(at.x), cell(at.y), cell(at.z)));
  };
  if (near.count == points.size()) {
    for_all([&](const Blocked& range) {
      for (std::size_t n = range.begin(); n < range.end(); ++n) keyed_[n] = {key(n), static_cast<std::uint32_t>(n)};
    });
  } else {
    std::size_t place = 0, far = near.count;
    for (std::size_t n = 0; n < points.size(); ++n) {
      const auto number = static_cast<std::uint32_t>(n);
      if (index.is_near(index.local(points[n])))
        keyed_[place++] = {key(n), number};
      else
        order[far++] = number;
    }
  }
  if (is_alone)
    std::ranges::sort(keyed_, {}, [](const KeyedIndex& one) { return std::uint64_t{one.key} << 32 | one.index; });
  else
    radix_sort(keyed_, tbb::this_task_arena::max_concurrency());
  for_all([&](const Blocked& range) {
    for (std::size_t n = range.begin(); n < range.end(); ++n) {
      if (n < near.count) order[n] = keyed_[n].index;
      in_order[n] = points[order[n]];
    }
  });
}

SortedPoints::Keys SortedPoints::keys_of(const cpu::Cell& cell, unsigned eighths) {
  const std::uint64_t first = morton(static_cast<std::uint64_t>(cell.low[0]), static_cast<std::uint64_t>(cell.low[1]),
                                     static_cast<std::uint64_t>(cell.low[2]));
  const auto side = static_cast<std::uint64_t>(cell.side);
  return {first, first + side * side * side * eighths / 8};
}

std::int64_t SortedPoints::first_at(std::uint64_t key, Range among) const {
  const auto at = std::partition_point(keyed_.begin() + among.begin, keyed_.begin() + among.end,
                                       [&](const KeyedIndex& keyed) { return keyed.key < key; });
  return at - keyed_.begin();
}

SortedPoints::Range SortedPoints::first_of(Range range, const cpu::Cell& cell, unsigned eighths) const {
  return {range.begin, first_at(keys_of(cell, eighths).end, range)};
}

std::int64_t SortedPoints::count_in(const cpu::Cell& cell) const {
  const Keys keys = keys_of(cell, 8);
  const Range all{0, size()};
  return first_at(keys.end, all) - first_at(keys.first, all);
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
