// SPDX-License-Identifier: Apache-2.0
// The sign's kernels for each instruction set, and the choice among them.
#include "sign/cpu/kernels.h"

#include "simd/dispatch.h"

namespace standoff::cpu {

namespace portable {
extern const SignKernels kSignKernels;
}
#ifdef __x86_64__
namespace avx2 {
extern const SignKernels kSignKernels;
}
namespace avx512 {
extern const SignKernels kSignKernels;
}
#endif

const SignKernels& sign_kernels_for(Simd simd) {
  static const Dispatch<SignKernels> kernels({
#ifdef __x86_64__
      {Simd::avx512, &avx512::kSignKernels},
      {Simd::avx2, &avx2::kSignKernels},
#endif
      {Simd::portable, &portable::kSignKernels},
  });
  return kernels.of(simd, "sign");
}

}  // namespace standoff::cpu
