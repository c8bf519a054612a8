// SPDX-License-Identifier: Apache-2.0
// The field's kernels for each instruction set, and the choice among them.
#include "field/cpu/kernels.h"

#include "simd/dispatch.h"

namespace standoff::cpu {

namespace portable {
extern const Kernels kKernels;
}
#ifdef __x86_64__
namespace avx2 {
extern const Kernels kKernels;
}
namespace avx512 {
extern const Kernels kKernels;
}
#endif

const Kernels& kernels_for(Simd simd) {
  static const Dispatch<Kernels> kernels({
#ifdef __x86_64__
      {Simd::avx512, &avx512::kKernels},
      {Simd::avx2, &avx2::kKernels},
#endif
      {Simd::portable, &portable::kKernels},
  });
  return kernels.of(simd, "compute");
}

}  // namespace standoff::cpu
