// SPDX-License-Identifier: Apache-2.0
// The kernels of sidecars for each instruction set, and the choice among them.
#include "sidecars/cpu/kernels.h"

#include "simd/dispatch.h"

namespace standoff::cpu {

namespace portable {
extern const SidecarKernels kSidecarKernels;
}
#ifdef __x86_64__
namespace avx2 {
extern const SidecarKernels kSidecarKernels;
}
namespace avx512 {
extern const SidecarKernels kSidecarKernels;
}
#endif

const SidecarKernels& sidecar_kernels_for(Simd simd) {
  static const Dispatch<SidecarKernels> kernels({
#ifdef __x86_64__
      {Simd::avx512, &avx512::kSidecarKernels},
      {Simd::avx2, &avx2::kSidecarKernels},
#endif
      {Simd::portable, &portable::kSidecarKernels},
  });
  return kernels.of(simd, "sidecars");
}

}  // namespace standoff::cpu
