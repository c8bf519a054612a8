// SPDX-License-Identifier: Apache-2.0
// The triangles of an index as a GPU reads them: a binary tree of boxes over them, in the index's order, in which
// neighbours are near each other.
#pragma once

#include <cstdint>
#include <vector>

#include "gpu/devices.h"

namespace standoff {

class TriangleIndex;

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

}  // namespace standoff
