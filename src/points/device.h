// SPDX-License-Identifier: Apache-2.0
// What a GPU does of queries at points: the nearest triangles. Sides, and all else, are the CPU's.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "gpu/devices.h"
#include "standoff/execution.h"
#include "standoff/vec.h"

namespace standoff {

class ProgressMeter;
class TriangleIndex;
struct DeviceTree;
struct FoundTriangles;

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

// The triangles of an index as a GPU reads them: a binary tree of boxes over them, in the index's order, in which
// neighbours are near each other.

/// The tree is complete: node n has the children 2n and 2n+1, its root is 1, and leaf n of `leaves` is node leaves + n.
/// Leaf n holds the entries from n * kLeaf on. Lengths of boxes are in grid units relative to `center`.
struct DeviceTree {
  static constexpr std::uint32_t kLeaf = 4;

  struct Node {
    float low[3], high[3];  ///< rounded outwards; empty (low above high) where there is no triangle
  };

  /// Runs on the threads of the calling TBB arena. The index must outlive it.
  explicit DeviceTree(const TriangleIndex& index);

  std::uint32_t triangles, leaves;  ///< `leaves` is a power of two
  double center[3];                 ///< world units
  double scale;                     ///< grid units per world unit
  float extent;                     ///< no coordinate of a box is larger
  std::vector<Node> nodes;          ///< the first is unused
  std::vector<double> corners;      ///< nine an entry, world units
  const std::uint32_t* indices;     ///< in the mesh, by entry
  gpu::DeviceCopies copies;
};

// The nearest triangles of many points, found by a device.

/// As find_nearest() of nearest.h, with the same bits. The tree is that of the index; `number` says which device.
void find_nearest_on_device(const PointDevice& device, int number, const DeviceTree& tree, const TriangleIndex& index,
                            std::span<const Vec3> points, FoundTriangles& found, ProgressMeter& progress);

}  // namespace standoff
