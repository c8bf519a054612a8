// SPDX-License-Identifier: Apache-2.0
// A GPU finds the nearest triangles of points. The CPU does the rest of a query, signs among it.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "gpu/devices.h"
#include "standoff/execution.h"
#include "standoff/vec.h"

namespace standoff {

namespace cpu {
struct PointKernels;
}
class ProgressMeter;
class TriangleIndex;
struct DeviceTree;
struct FoundTriangles;

/// The squared distance, and the lowest index of the triangles at this distance.
struct DeviceNearest {
  double distance_sq;  ///< grid units
  std::uint32_t triangle;
  std::uint32_t padding = 0;
};

/// Points for which TriangleIndex::is_near() holds. The search is faster if neighbours in space are neighbours here.
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

/// The device that answers this number of points; null for the CPU. Throws Error{device} if the backend is missing.
const PointDevice* find_point_device(Backend backend, std::size_t points);

/// The triangles of an index as a GPU reads them: a binary tree of boxes over the entries of the index's BVH, where
/// neighbours are near each other.
///
/// The tree is complete: node n has the children 2n and 2n+1, its root is 1, and leaf n of `leaves` is node leaves + n.
/// Leaf n holds kLeaf entries from n * kLeaf on. Coordinates of boxes are in grid units relative to `center`.
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
  float extent;                     ///< the largest coordinate of a box, in magnitude
  std::vector<Node> nodes;          ///< the first is unused
  std::vector<double> corners;      ///< nine numbers per entry, world units
  const std::uint32_t* indices;     ///< the triangle of each entry
  gpu::DeviceCopies copies;
};

/// Does what find_nearest() of nearest.h does, with the same bits. `tree` was made from `index`; `number` says which
/// device.
void find_nearest_on_device(const PointDevice& device, int number, const DeviceTree& tree, const TriangleIndex& index,
                            const cpu::PointKernels& kernels, std::span<const Vec3> points, FoundTriangles& found,
                            ProgressMeter& progress);

}  // namespace standoff
