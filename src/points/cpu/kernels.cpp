// SPDX-License-Identifier: Apache-2.0
// The kernels of queries at points for each instruction set, and the choice among them.
#include "points/cpu/kernels.h"

#include "simd/dispatch.h"

namespace standoff::cpu {

namespace portable {
extern const PointKernels kPointKernels;
}
#ifdef __x86_64__
namespace avx2 {
extern const PointKernels kPointKernels;
}
namespace avx512 {
extern const PointKernels kPointKernels;
}
#endif

const PointKernels& point_kernels_for(Simd simd) {
  static const Dispatch<PointKernels> kernels({
#ifdef __x86_64__
      {Simd::avx512, &avx512::kPointKernels},
      {Simd::avx2, &avx2::kPointKernels},
#endif
      {Simd::portable, &portable::kPointKernels},
  });
  return kernels.of(simd, "points");
}

}  // namespace standoff::cpu
