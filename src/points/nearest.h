// SPDX-License-Identifier: Apache-2.0
// The nearest triangle of each of many points (docs/points.md).
#pragma once

#include <cstdint>
#include <limits>
#include <span>

#include "core/memory.h"
#include "core/progress.h"
#include "points/cpu/kernels.h"
#include "points/sorted_points.h"
#include "points/triangle_index.h"
#include "standoff/vec.h"

namespace standoff {

struct NearestTriangle {
  double distance = std::numeric_limits<double>::infinity();  ///< world units
  std::uint32_t triangle = kNoTriangle;                       ///< the lowest of those equally near
};

/// The most points of a call: what is held for sorting them stays in bounds.
inline constexpr std::size_t kMostPoints = std::size_t{1} << 20;

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

/// Requires at most kMostPoints points, all finite. Up to kTogether points are answered by the calling thread, which
/// takes no memory once it has answered as many before, more of them on the threads of its TBB arena. Advances the
/// progress by one for each point. Throws Error{interrupted}.
void find_nearest(const TriangleIndex& index, const cpu::PointKernels& kernels, std::span<const Vec3> points,
                  FoundTriangles& found, ProgressMeter& progress);

/// The same for a single point, which may be anywhere: in double, box by box.
NearestTriangle find_nearest(const TriangleIndex& index, Vec3 point);

}  // namespace standoff
