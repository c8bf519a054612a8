// SPDX-License-Identifier: Apache-2.0
// Which triangles are set up for samples in float, and which in double. This decides bits, so the CPU, sixteen
// triangles at a time, and the GPU, one, ask here.
#pragma once

#include "field/tolerances.h"
#include "geometry/triangle_box.h"

namespace standoff {

/// Whether a triangle whose corners have this box, in coordinates of a brick in F, is set up in double and measured by
/// lines: bool for float, a mask for wide floats.
template <class F>
STANDOFF_INLINE auto is_long(const BoxOf<F>& box) {
  return less(F(kLongTriangle), longest_side(box));
}

}  // namespace standoff
