// SPDX-License-Identifier: Apache-2.0
// The triangle closest to a point, for the few points that no field has an answer for.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "sign/diagnosis/box_tree.h"
#include "standoff/mesh.h"

namespace standoff {

class ClosestTriangle {
 public:
  /// Requires a valid mesh that outlives this. Takes 12 bytes for each triangle while it is made, 8 afterwards. Runs on
  /// the threads of the calling TBB arena.
  explicit ClosestTriangle(MeshView mesh);

  /// kNoTriangle if there is none. In double: one that is farther by some roundings of its distance may be taken for
  /// the closest, and of equally close ones any, always the same. Takes logarithmic time where few triangles are about
  /// as close; at the worst it looks at all.
  std::uint32_t to(const Vec3& p) const;

 private:
  static constexpr std::size_t kRun = 16;  // triangles for each box: few boxes, and few triangles looked at in vain

  MeshView mesh_;
  std::vector<std::uint32_t> order_;  // triangles, near ones together
  BoxTree runs_;
};

}  // namespace standoff
