// SPDX-License-Identifier: Apache-2.0
// The triangle closest to a point, for the few points that no field has an answer for.
#pragma once

#include <cstdint>

#include "bvh/bvh.h"
#include "standoff/mesh.h"

namespace standoff {

class ClosestTriangle {
 public:
  /// Requires a valid mesh that outlives this. Takes some 50 bytes for each triangle while it is made, 30 afterwards.
  /// Runs on the threads of the calling TBB arena.
  explicit ClosestTriangle(MeshView mesh);

  /// kNoTriangle if there is none. In double: one that is farther by some roundings of its distance may be taken for
  /// the closest. Takes logarithmic time where few triangles are about as close; at the worst it looks at all.
  std::uint32_t to(const Vec3& p) const { return nearest_triangle(bvh_, mesh_, p).triangle; }

 private:
  MeshView mesh_;
  Bvh bvh_;
};

}  // namespace standoff
