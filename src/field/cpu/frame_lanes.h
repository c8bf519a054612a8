// SPDX-License-Identifier: Apache-2.0
// The frames of sixteen triangles in memory: a register for each number of TriangleFrame (geometry/triangle_frame.h),
// lane n of which belongs to triangle n.
#pragma once

#include "field/cpu/lattice.h"

namespace standoff::cpu {

struct alignas(64) FrameLanes {
  /// Linear: the gradient and the constant.
  struct Line {
    float gx[kLanes], gy[kLanes], gz[kLanes], c[kLanes];
  };
  /// HalfTriangle.
  struct Half {
    float leg[kLanes], length[kLanes], nx[kLanes], ny[kLanes];
  };
  Line q, y, z;
  Half left, right;
};

}  // namespace standoff::cpu
