// SPDX-License-Identifier: Apache-2.0
// What a GPU does of queries at points: the nearest triangles. Sides, and all else, are the CPU's.
#pragma once

#include <cstdint>
#include <span>

#include "points/device_tree.h"
#include "standoff/execution.h"
#include "standoff/vec.h"

namespace standoff {

/// The squared distance, and the lowest of the triangles that are so near.
struct DeviceNearest {
  double distance_sq;  ///< grid units
  std::uint32_t triangle;
  std::uint32_t padding = 0;
};

/// Points that are near() to the index; the better they are sorted, the faster.
struct NearestJob {
  const DeviceTree& tree;
  std::span<const Vec3> points;
  std::span<DeviceNearest> found;
  int device;
};

/// A row of the table of devices (src/backends/fields.cpp).
struct PointDevice {
  Backend backend;
  bool (*available)();
  void (*find_nearest)(const NearestJob&);
};

/// The device for so many points; null for the CPU. Throws Error{device} where a backend is asked for that there is
/// not.
const PointDevice* find_point_device(Backend backend, std::size_t points);

}  // namespace standoff
