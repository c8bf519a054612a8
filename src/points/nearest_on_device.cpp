// SPDX-License-Identifier: Apache-2.0
// Blocks of points to a device and back. Points go along a Morton curve, so that the threads of a warp go the same
// ways.
#include "points/nearest_on_device.h"

#include <tbb/parallel_for.h>

#include <cmath>

namespace standoff {

void find_nearest_on_device(const PointDevice& device, int number, const DeviceTree& tree, const TriangleIndex& index,
                            std::span<const Vec3> points, FoundTriangles& found, ProgressMeter& progress) {
  SortedPoints& sorted = found.sorted;
  sorted.sort(index, points, found.order, found.points);
  const auto near = static_cast<std::size_t>(sorted.size());
  found.nearest.resize(points.size());
  std::vector<DeviceNearest> answers(near);
  if (near > 0) device.find_nearest({tree, std::span(found.points).first(near), answers, number});
  tbb::parallel_for(std::size_t{0}, near, [&](std::size_t n) {
    found.nearest[n] = {std::sqrt(answers[n].distance_sq) / tree.scale, answers[n].triangle};
  });
  progress.advance(sorted.size());
  tbb::parallel_for(near, points.size(), [&](std::size_t n) {
    found.nearest[n] = find_nearest(index, found.points[n]);
    progress.advance();
  });
}

}  // namespace standoff
