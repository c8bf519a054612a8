// SPDX-License-Identifier: Apache-2.0
// A block of points along a Morton curve: the points of a cell are consecutive, and so are those of its parts.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "field/cpu/cells.h"
#include "field/cpu/kernels.h"
#include "field/cpu/radix_sort.h"
#include "points/triangle_index.h"

namespace standoff {

/// The points lie in a cube of kSide^3 cells. Lengths are in grid units relative to the middle of the index.
class SortedPoints {
 public:
  static constexpr int kBits = 10;
  static constexpr std::int64_t kSide = std::int64_t{1} << kBits;

  struct Range {
    std::int64_t begin, end;
    std::int64_t size() const { return end - begin; }
  };

  /// Runs on the threads of the calling TBB arena.
  SortedPoints(const TriangleIndex& index, std::span<const Vec3> points);

  /// Of those near enough to the mesh for boxes in float; they alone are sorted.
  std::int64_t size() const { return std::ssize(keyed_); }
  /// The others.
  std::span<const std::uint32_t> far() const { return far_; }
  std::uint32_t index(std::int64_t n) const { return keyed_[static_cast<std::size_t>(n)].index; }
  const Vec3& local(std::int64_t n) const { return local_[index(n)]; }

  /// What of a range, whose points are in none of the cells before this one in Morton order, is in it.
  Range first_of(Range range, const cpu::Cell& cell) const;
  /// A box around the points of a cell.
  cpu::CullCell cull_cell(const cpu::Cell& cell) const;

 private:
  std::vector<cpu::KeyedIndex> keyed_;
  std::vector<std::uint32_t> far_;
  std::vector<Vec3> local_;  // by index
  Vec3 low_;
  double cell_ = 1;  // side of a cell
};

}  // namespace standoff
