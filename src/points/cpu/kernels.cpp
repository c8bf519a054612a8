// SPDX-License-Identifier: Apache-2.0
// The kernels of queries at points for each instruction set, and the choice among them.
#include "points/cpu/kernels.h"

#include "simd/dispatch.h"

namespace standoff::cpu {

const PointKernels& point_kernels_for(Simd simd) {
  static const Dispatch<PointKernels> kernels;
  return kernels.of(simd, "points");
}

}  // namespace standoff::cpu
