// SPDX-License-Identifier: Apache-2.0
// An implicit 16-wide BVH over the triangles of a body: node n of a level has the nodes 16 n to 16 n + 15 of the level
// below as children. Level 0 holds the triangles themselves.
#pragma once

#include <cstdint>
#include <vector>

#include "collision/body/simd_blocks.h"
#include "core/memory.h"
#include "core/progress.h"
#include "geometry/triangle_pair.h"
#include "standoff/mesh.h"

namespace standoff::collision {

struct BvhLevel {
  HugePageVector<Sphere16> spheres;  ///< packet n: the children of node n of the level above
  HugePageVector<Aabb16> boxes;
};

struct Bvh16 {
  std::vector<std::uint32_t> order;  ///< triangles of the mesh, by their index in the BVH
  std::vector<BvhLevel> levels;      ///< the last one has a single packet
  HugePageVector<Triangle16>
      triangles;  ///< the triangles, in packets of the lowest level; lanes left over repeat the last one
  int top() const { return static_cast<int>(levels.size()) - 1; }
};

/// Builds the BVH over triangles whose coordinates are taken relative to `middle`. Triangles that are near each other
/// come to stand together: ranges are halved, in multiples of full nodes, along the longest side of their centres' box.
/// The same on every run, by any number of threads. The progress can end it.
Bvh16 build_bvh(MeshView mesh, Vec3 middle, ProgressMeter& progress);

/// The spheres and boxes of a BVH whose order is given. The progress can end it.
void fill_levels(Bvh16& bvh, MeshView mesh, Vec3 middle, ProgressMeter& progress);

}  // namespace standoff::collision
