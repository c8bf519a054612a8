// SPDX-License-Identifier: Apache-2.0
// The nearest triangle of each of many points (docs/points.md).
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>

#include "bvh/bvh.h"
#include "bvh/order.h"
#include "core/memory.h"
#include "core/progress.h"
#include "field/cpu/candidate_culling.h"
#include "field/cpu/kernels.h"
#include "points/cpu/kernels.h"
#include "points/triangle_index.h"
#include "standoff/vec.h"

namespace standoff {

// A block of points along a Morton curve: the points of a cell are consecutive, and so are those of its parts.

/// The points lie in a cube of kSide^3 cells. Lengths are in grid units relative to the middle of the index.
class SortedPoints {
 public:
  static constexpr int kBits = 10;
  static constexpr std::int64_t kSide = std::int64_t{1} << kBits;

  struct Range {
    std::int64_t begin, end;
    std::int64_t size() const { return end - begin; }
  };

  /// Sorts points, in place of those before. `order` becomes the indices of the points in their order, `in_order` the
  /// points. Far points come last. Up to kAlone points are sorted by the calling thread, more of them on the threads of
  /// its TBB arena.
  void sort(const TriangleIndex& index, std::span<const Vec3> points, HugePageVector<std::uint32_t>& order,
            HugePageVector<Vec3>& in_order);
  static constexpr std::size_t kAlone = 1024;

  /// Of those near enough to the mesh for boxes in float; they alone are sorted.
  std::int64_t size() const { return std::ssize(keyed_); }

  /// What of a range is in the eighths of a cell before number `end` of them, in Morton order. The points of the range
  /// are in the cell.
  Range first_of(Range range, const cpu::Cell& cell, unsigned end) const;
  /// How many points are in a cell.
  std::int64_t count_in(const cpu::Cell& cell) const;
  /// A box around the points of a cell.
  cpu::CullCell cull_cell(const cpu::Cell& cell) const;

 private:
  // The first key of a cell, and one past those of its first eighths.
  struct Keys {
    std::uint64_t first, end;
  };
  static Keys keys_of(const cpu::Cell& cell, unsigned eighths);
  std::int64_t first_at(std::uint64_t key, Range among) const;

  HugePageVector<KeyedIndex> keyed_;
  Vec3 low_;
  double cell_ = 1;  // side of a cell
};

// The search.

struct NearestTriangle {
  double distance = std::numeric_limits<double>::infinity();  ///< world units
  std::uint32_t triangle = kNoTriangle;                       ///< the lowest of those equally near
};

/// The most points of a call: what is held for sorting them stays in bounds.
inline constexpr std::size_t kMostPointsAtOnce = std::size_t{1} << 20;

/// Points that are answered together, by one thread.
inline constexpr std::size_t kTogether = SortedPoints::kAlone;

/// Points in an order in which neighbours are near each other, and their answers. Fewer points than before take no
/// memory.
struct FoundTriangles {
  SortedPoints sorted;
  HugePageVector<std::uint32_t> order;  ///< which point of those asked each one is
  HugePageVector<Vec3> points;
  HugePageVector<NearestTriangle> nearest;
};

/// Requires at most kMostPointsAtOnce points, all finite. Up to kTogether points are answered by the calling thread,
/// which takes no memory once it has answered as many before, more of them on the threads of its TBB arena. Advances
/// the progress by one for each point. Throws Error{interrupted}.
void find_nearest(const TriangleIndex& index, const cpu::PointKernels& kernels, std::span<const Vec3> points,
                  FoundTriangles& found, ProgressMeter& progress);

/// The same for a single point, which may be anywhere: in double, box by box.
NearestTriangle find_nearest(const TriangleIndex& index, Vec3 point);

}  // namespace standoff
