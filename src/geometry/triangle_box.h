// SPDX-License-Identifier: Apache-2.0
// The box of a triangle.
#pragma once

#include "geometry/triple.h"
#include "standoff/mesh.h"

namespace standoff {

/// The lowest and the highest coordinates of three points.
template <class F>
struct BoxOf {
  Triple<F> low, high;
};

template <class F>
STANDOFF_INLINE BoxOf<F> box_of(const Triple<F>& a, const Triple<F>& b, const Triple<F>& c) {
  return {{min(a.x, min(b.x, c.x)), min(a.y, min(b.y, c.y)), min(a.z, min(b.z, c.z))},
          {max(a.x, max(b.x, c.x)), max(a.y, max(b.y, c.y)), max(a.z, max(b.z, c.z))}};
}

template <class F>
STANDOFF_INLINE F longest_side(const BoxOf<F>& box) {
  return max(box.high.x - box.low.x, max(box.high.y - box.low.y, box.high.z - box.low.z));
}

/// The box of a triangle of a mesh. Requires a valid triangle.
inline Box triangle_box(const MeshView& mesh, std::size_t triangle) {
  const auto [a, b, c] = mesh.corners(triangle);
  return {min(a, min(b, c)), max(a, max(b, c))};
}

}  // namespace standoff
