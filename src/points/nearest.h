// SPDX-License-Identifier: Apache-2.0
// The nearest triangle of each of many points (docs/points.md).
#pragma once

#include <cstdint>
#include <limits>
#include <span>

#include "core/huge_page_vector.h"
#include "core/progress.h"
#include "points/cpu/kernels.h"
#include "points/triangle_index.h"
#include "standoff/vec.h"

namespace standoff {

struct NearestTriangle {
  double distance = std::numeric_limits<double>::infinity();  ///< world units
  std::uint32_t triangle = kNoTriangle;                       ///< the lowest of those equally near
};

/// The most points of a call: what is held for sorting them stays in bounds.
inline constexpr std::size_t kMostPoints = std::size_t{1} << 20;

/// Points in an order in which neighbours are near each other, and their answers.
struct FoundTriangles {
  HugePageVector<std::uint32_t> order;  ///< which point of those asked each one is
  HugePageVector<Vec3> points;
  HugePageVector<NearestTriangle> nearest;
};

/// Requires at most kMostPoints points, all finite. Runs on the threads of the calling TBB arena; advances the progress
/// by one for each point. Throws Error{interrupted}.
void find_nearest(const TriangleIndex& index, const cpu::PointKernels& kernels, std::span<const Vec3> points,
                  FoundTriangles& found, ProgressMeter& progress);

/// The same for a single point.
NearestTriangle find_nearest(const TriangleIndex& index, Vec3 point);

}  // namespace standoff
