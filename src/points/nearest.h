// SPDX-License-Identifier: Apache-2.0
// The nearest triangle of each of many points (docs/points_methods.md).
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

/// A block of points sorted along a Morton curve: the points of a cell are consecutive, and so are the points of each
/// octant. They lie in a cube of kSide^3 cells. Lengths are in grid units relative to the middle of the index.
class SortedPoints {
 public:
  static constexpr int kBits = 10;
  static constexpr std::int64_t kSide = std::int64_t{1} << kBits;

  struct Range {
    std::int64_t begin, end;
    std::int64_t size() const { return end - begin; }
  };

  /// Replaces the points by new ones, and sorts them. `in_order` becomes the points in Morton order, `order` their
  /// indices in `points`. Points that are not near (TriangleIndex::is_near) come last. The calling thread sorts up to
  /// kAlone points itself; the threads of its TBB arena sort more of them.
  void sort(const TriangleIndex& index, std::span<const Vec3> points, HugePageVector<std::uint32_t>& order,
            HugePageVector<Vec3>& in_order);
  static constexpr std::size_t kAlone = 1024;

  /// The number of near points. Only they are sorted.
  std::int64_t size() const { return std::ssize(keyed_); }

  /// The part of a range that lies in the first `end` octants of a cell, in Morton order. Requires that all points of
  /// the range are in the cell.
  Range first_of(Range range, const cpu::Cell& cell, unsigned end) const;
  /// How many points are in a cell.
  std::int64_t count_in(const cpu::Cell& cell) const;
  /// A box around the points of a cell.
  cpu::CullCell cull_cell(const cpu::Cell& cell) const;

 private:
  // The first key of a cell, and one past the last key of its first octants.
  struct Keys {
    std::uint64_t first, end;
  };
  static Keys keys_of(const cpu::Cell& cell, unsigned octants);
  std::int64_t first_at(std::uint64_t key, Range among) const;

  HugePageVector<KeyedIndex> keyed_;
  Vec3 low_;
  double cell_ = 1;  // side of a cell
};

/// The most points of a call: it bounds the memory for sorting them.
inline constexpr std::size_t kMostPointsAtOnce = std::size_t{1} << 20;

/// One thread answers this number of points together.
inline constexpr std::size_t kTogether = SortedPoints::kAlone;

/// Points in an order in which neighbours are near each other, and their answers. Reuse allocates nothing for fewer
/// points than before.
struct FoundTriangles {
  SortedPoints sorted;
  HugePageVector<std::uint32_t> order;  ///< the index of each in the caller's points
  HugePageVector<Vec3> points;
  HugePageVector<NearestTriangle> nearest;
};

/// Requires at most kMostPointsAtOnce points, all finite. The calling thread answers up to kTogether points itself, and
/// allocates nothing once it has answered this number before; the threads of its TBB arena answer more of them.
/// Advances the progress by one for each point. Throws Error{interrupted}.
void find_nearest(const TriangleIndex& index, const cpu::PointKernels& kernels, std::span<const Vec3> points,
                  FoundTriangles& found, ProgressMeter& progress);

/// The same, but each point is searched for by itself: for points too far away to share candidates.
void find_each(const TriangleIndex& index, const cpu::PointKernels& kernels, std::span<const Vec3> points,
               std::span<NearestTriangle> out, ProgressMeter& progress);

}  // namespace standoff
