// SPDX-License-Identifier: Apache-2.0
// What CPU and GPU do alike in a tile, so that the sidecars have the same bits: which triangles are prepared once for
// all of their samples, and for how far.
#pragma once

#include "geometry/triple.h"

namespace standoff {

/// Whether one more triangle of a tile is to be prepared, after `triangles` of them have `samples` samples together.
/// Triangles come in the order of their first samples. Stops where eight or more have fewer than five each on average.
STANDOFF_INLINE bool prepares_more(int triangles, int samples) {
  constexpr int kTriangles = 8, kLeastSamples = 5;
  return triangles < kTriangles || samples >= kLeastSamples * triangles;
}

/// An upper bound of the squared distance between a point and the samples of a tile, whose corners are given.
template <class F>
STANDOFF_INLINE F reach_sq(const Triple<F>& low, const Triple<F>& high, const Triple<F>& point) {
  const F x = max(point.x - low.x, high.x - point.x), y = max(point.y - low.y, high.y - point.y),
          z = max(point.z - low.z, high.z - point.z);
  return x * x + y * y + z * z;
}

}  // namespace standoff
