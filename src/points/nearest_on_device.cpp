// SPDX-License-Identifier: Apache-2.0
// Blocks of points to a device and back. Points go along a Morton curve, so that the threads of a warp go the same
// ways.
#include "points/nearest_on_device.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "points/sorted_points.h"

namespace standoff {

void find_nearest_on_device(const PointDevice& device, int number, const DeviceTree& tree, const TriangleIndex& index,
                            std::span<const Vec3> points, std::span<NearestTriangle> out,
                            std::vector<std::uint32_t>& order, ProgressMeter& progress) {
  const SortedPoints sorted(index, points);
  const auto near = static_cast<std::size_t>(sorted.size());
  order.resize(points.size());
  for (std::size_t n = 0; n < near; ++n) order[n] = sorted.index(static_cast<std::int64_t>(n));
  std::ranges::copy(sorted.far(), order.begin() + sorted.size());
  std::vector<Vec3> asked(near);
  std::vector<DeviceNearest> found(near);
  tbb::parallel_for(std::size_t{0}, near, [&](std::size_t n) { asked[n] = points[order[n]]; });
  if (near > 0) device.find_nearest({tree, asked, found, number});
  tbb::parallel_for(std::size_t{0}, near, [&](std::size_t n) {
    out[order[n]] = {std::sqrt(found[n].distance_sq) / tree.scale, found[n].triangle};
  });
  progress.advance(sorted.size());
  tbb::parallel_for(near, points.size(), [&](std::size_t n) {
    out[order[n]] = find_nearest(index, points[order[n]]);
    progress.advance();
  });
}

}  // namespace standoff
